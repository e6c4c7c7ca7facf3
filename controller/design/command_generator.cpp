#include "controller/design/command_generator.h"

#include <algorithm>
#include <stdexcept>

#include "model/math/dense_decompositions.h"
#include "model/math/riccati.h"

namespace flexarm {
namespace {

TrackingProblem Scaled(const TrackingProblem& p) {
  const Eigen::VectorXd inverse = p.scale.cwiseInverse();
  return {.A = inverse.asDiagonal() * p.A * p.scale.asDiagonal(),
          .B = inverse.asDiagonal() * p.B,
          .Cp = p.Cp * p.scale.asDiagonal(),
          .Am = inverse.asDiagonal() * p.Am * p.scale.asDiagonal(),
          .Bm = inverse.asDiagonal() * p.Bm,
          .Cm = p.Cm * p.scale.asDiagonal(),
          .scale = Eigen::VectorXd::Ones(p.scale.size())};
}

// [A - I, B; C_p, 0], whose inverse is Omega.
Eigen::MatrixXd SteadyState(const TrackingProblem& z) {
  const Eigen::Index n = z.A.rows(), m = z.B.cols();
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m, n + m);
  system.topLeftCorner(n, n) = z.A - Eigen::MatrixXd::Identity(n, n);
  system.topRightCorner(n, m) = z.B;
  system.bottomLeftCorner(m, n) = z.Cp;
  return system;
}

}  // namespace

CommandGenerator SolveCommandGenerator(const TrackingProblem& problem) {
  const TrackingProblem z = Scaled(problem);
  const Eigen::Index n = z.A.rows(), m = z.B.cols();
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);

  const Eigen::MatrixXd system = SteadyState(z);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(system);
  const double condition = svd.singularValues()(0) / svd.singularValues()(n + m - 1);
  if (!(condition < 1e12)) {
    throw std::runtime_error(
        "command generator: the plant has an invariant zero at z = 1, so no steady state follows "
        "the "
        "reference");
  }
  const Eigen::MatrixXd Omega = system.inverse();
  const auto O11 = Omega.topLeftCorner(n, n);
  const auto O12 = Omega.topRightCorner(n, m);
  const auto O21 = Omega.bottomLeftCorner(m, n);
  const auto O22 = Omega.bottomRightCorner(m, m);

  // S11 - O11 S11 (Am - I) = O12 Cm.
  const Eigen::MatrixXd S11 = SolveStein(O11, z.Am - I, O12 * z.Cm);
  const Eigen::MatrixXd S12 = O11 * S11 * z.Bm;
  const Eigen::MatrixXd S21 = O21 * S11 * (z.Am - I) + O22 * z.Cm;
  const Eigen::MatrixXd S22 = O21 * S11 * z.Bm;

  const Eigen::VectorXd& scale = problem.scale;
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  return {.S11 = scale.asDiagonal() * S11 * inverse.asDiagonal(),
          .S12 = scale.asDiagonal() * S12,
          .S21 = S21 * inverse.asDiagonal(),
          .S22 = S22,
          .condition = condition};
}

double SteinCondition(const TrackingProblem& problem) {
  const TrackingProblem z = Scaled(problem);
  const Eigen::Index n = z.A.rows();
  const Eigen::MatrixXd Omega = SteadyState(z).inverse();
  const Eigen::MatrixXd right = (z.Am - Eigen::MatrixXd::Identity(n, n)).transpose();
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(n * n, n * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      system.block(i * n, j * n, n, n) -= right(i, j) * Omega.topLeftCorner(n, n);
    }
  }
  const Eigen::VectorXd singular = Eigen::JacobiSVD<Eigen::MatrixXd>(system).singularValues();
  return singular(0) / singular(n * n - 1);
}

double TrackingResidual(const TrackingProblem& problem, const CommandGenerator& generator) {
  const TrackingProblem z = Scaled(problem);
  const Eigen::VectorXd inverse = problem.scale.cwiseInverse();
  const Eigen::MatrixXd S11 = inverse.asDiagonal() * generator.S11 * problem.scale.asDiagonal();
  const Eigen::MatrixXd S12 = inverse.asDiagonal() * generator.S12;
  const Eigen::MatrixXd S21 = generator.S21 * problem.scale.asDiagonal();
  const Eigen::MatrixXd& S22 = generator.S22;
  return std::max({(z.A * S11 + z.B * S21 - S11 * z.Am).cwiseAbs().maxCoeff(),
                   (z.A * S12 + z.B * S22 - S11 * z.Bm - S12).cwiseAbs().maxCoeff(),
                   (z.Cp * S11 - z.Cm).cwiseAbs().maxCoeff(), (z.Cp * S12).cwiseAbs().maxCoeff()});
}

}  // namespace flexarm
