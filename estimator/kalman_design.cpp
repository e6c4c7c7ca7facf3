#include "estimator/kalman_design.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "estimator/gauge_model.h"
#include "estimator/unfitted_mode.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/math/riccati.h"
#include "model/units.h"

namespace flexarm {
namespace {

// Regularises W: keeps the Riccati equation definite, far below every physical noise (SI units).
constexpr double kCovarianceFloor = 1e-13;

// The model has modes that the fit lacks.
bool FitLacksModes(const StateLayout& layout, const EstimatorConfig& estimator) {
  return estimator.modes_per_link < layout.modes_per_link;
}

Eigen::MatrixXd OutputMatrix(const StateLayout& layout, Eigen::Index states) {
  const Eigen::Index flex = Eigen::Index{2} * layout.modes_per_link;
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(layout.outputs(), states);
  for (int joint = 0; joint < 2; ++joint) {
    C(joint, layout.hub(joint)) = 1.0;
    C(2 + joint, layout.rotor(joint)) = 1.0;
  }
  C.block(4, layout.states(), flex, flex).setIdentity();
  return C;
}

// Variances of the outputs: quantisation q^2/12 of the counters, stated noise of the rest.
Eigen::VectorXd OutputVariance(const SensorConfig& sensors, const EstimatorConfig& estimator,
                               const StateLayout& layout) {
  Eigen::VectorXd R = Eigen::VectorXd::Ones(layout.outputs());
  for (const EncoderConfig& encoder : sensors.encoder) {
    const double q = kTwoPi / encoder.counts_per_turn;
    const auto joint = static_cast<std::size_t>(encoder.counter % 2);
    const double extra = encoder.counter >= 2 ? estimator.rotor_extra_sigma_rad[joint]
                                              : estimator.hub_extra_sigma_rad[joint];
    R(encoder.counter) = q * q / 12.0 + extra * extra;
  }
  for (int link = 0; link < 2; ++link) {
    for (int mode = 0; mode < layout.modes_per_link; ++mode) {
      const auto row = static_cast<std::size_t>(link), column = static_cast<std::size_t>(mode);
      const double sigma = estimator.modal_sigma_m[2 * row + column];
      R(layout.output(layout.mode(link, mode))) = sigma * sigma;
    }
  }
  return R;
}

// G: generalised forces on all degrees of freedom.
Eigen::MatrixXd ForceMatrix(const NominalModel& nominal, Eigen::Index states) {
  const Eigen::Index dof = nominal.M.rows();
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(dof, dof);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(states, dof);
  G.middleRows(dof, dof) = nominal.M.llt().solve(I);
  return G;
}

Eigen::VectorXd ForceSigma(const StateLayout& layout, const EstimatorConfig& estimator) {
  Eigen::VectorXd sigma(layout.dof());
  for (int i = 0; i < 2; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    sigma(layout.hub(i)) = sigma(layout.rotor(i)) = estimator.process_force[joint];
    for (int j = 0; j < layout.modes_per_link; ++j) {
      sigma(layout.mode(i, j)) =
          estimator.process_force[2 + 2 * joint + static_cast<std::size_t>(j)];
    }
  }
  return sigma;
}

Eigen::MatrixXd ProcessNoise(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                             const Eigen::VectorXd& sigma, double period_s) {
  const Eigen::MatrixXd G_d = ZeroOrderHold(A, G, period_s).B;
  const Eigen::MatrixXd scaled = G_d * sigma.asDiagonal();
  return scaled * scaled.transpose() +
         kCovarianceFloor * Eigen::MatrixXd::Identity(A.rows(), A.rows());
}

// The filter's Riccati equation is the controller's of the transposed system.
Eigen::MatrixXd SteadyCovariance(const NominalModel& nominal, const Eigen::MatrixXd& A_t,
                                 const Eigen::MatrixXd& C_t, const Eigen::MatrixXd& W,
                                 const Eigen::MatrixXd& R) {
  try {
    return SolveDare(A_t, C_t, W, R);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(
        "the sensors of the rig do not determine the state of the nominal model " +
        std::string(NameOf(nominal.layout)) + " (" + error.what() + ")");
  }
}

bool IsMeasured(Eigen::Index output, const StateLayout& layout, const SensorConfig& sensors,
                const EstimatorConfig& estimator) {
  if (output < kCounters) return (sensors.counters_present() >> output & 1u) != 0;
  return (output - kCounters) % layout.modes_per_link < estimator.modes_per_link;
}

}  // namespace

KalmanDesign DesignKalmanFilter(const NominalModel& nominal, const ArmParameters& arm,
                                const SensorConfig& sensors, const EstimatorConfig& estimator,
                                double period_s) {
  const StateLayout& layout = nominal.layout;
  const LinearModel system =
      WithGaugeFilter(nominal.A, nominal.B, layout.mode(0, 0),
                      Eigen::Index{2} * layout.modes_per_link, sensors.strain_input);
  const DiscreteModel discrete = ZeroOrderHold(system.A, system.B, period_s);
  Eigen::MatrixXd C_all = OutputMatrix(layout, system.A.rows());
  if (FitLacksModes(layout, estimator)) {
    const std::array<double, 2> second_in_first = SecondModeInFirst(arm, sensors);
    for (int link = 0; link < 2; ++link) {
      const Eigen::Index second = layout.output(layout.mode(link, 1));
      C_all.row(layout.output(layout.mode(link, 0))) +=
          second_in_first[static_cast<std::size_t>(link)] * C_all.row(second);
    }
  }
  const Eigen::VectorXd R_all = OutputVariance(sensors, estimator, layout);

  std::vector<Eigen::Index> present;  // rows of C with a sensor on this rig
  for (Eigen::Index row = 0; row < C_all.rows(); ++row) {
    if (IsMeasured(row, layout, sensors, estimator)) present.push_back(row);  // start-up
  }
  const Eigen::MatrixXd C = C_all(present, Eigen::all);
  const Eigen::MatrixXd R = Eigen::VectorXd(R_all(present)).asDiagonal();
  const Eigen::MatrixXd W = ProcessNoise(system.A, ForceMatrix(nominal, system.A.rows()),
                                         ForceSigma(layout, estimator), period_s);

  const Eigen::MatrixXd A_t = discrete.A.transpose(), C_t = C.transpose();
  const Eigen::MatrixXd P = SteadyCovariance(nominal, A_t, C_t, W, R);
  const Eigen::MatrixXd CP = C * P, S = CP * C_t + R;
  const Eigen::MatrixXd gain = S.llt().solve(CP).transpose();

  KalmanDesign design{.A = discrete.A,
                      .B = discrete.B,
                      .C = C_all,
                      .L = Eigen::MatrixXd::Zero(system.A.rows(), C_all.rows()),
                      .A_rate = system.A,
                      .B_rate = system.B,
                      .W = W,
                      .P = P,
                      .R = R_all,
                      .residual = DareResidual(A_t, C_t, W, R, P)};
  for (std::size_t i = 0; i < present.size(); ++i) {
    design.L.col(present[i]) = gain.col(static_cast<Eigen::Index>(i));
  }
  return design;
}

}  // namespace flexarm
