#include "estimator/kalman_design.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <vector>

#include "estimator/gauge_model.h"
#include "model/discretize.h"
#include "model/riccati.h"

namespace flexarm {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Regularises W: keeps the Riccati equation definite, far below every physical noise (SI units).
constexpr double kNoiseFloor = 1e-13;

Eigen::MatrixXd OutputMatrix(Eigen::Index n, Eigen::Index flex, Eigen::Index states) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(4 + flex, states);
  C(0, 0) = C(1, 1) = C(2, 0) = C(3, 1) = 1.0;
  C.block(4, n, flex, flex).setIdentity();
  return C;
}

// Variances of the outputs: quantisation q^2/12 of the counters, stated noise of the rest.
Eigen::VectorXd OutputVariance(const SensorConfig& sensors, const EstimatorConfig& estimator,
                               Eigen::Index flex) {
  Eigen::VectorXd R = Eigen::VectorXd::Ones(4 + flex);
  for (const EncoderConfig& encoder : sensors.encoder) {
    const double q = kTwoPi / encoder.counts_per_turn;
    const bool rotor = encoder.counter >= 2;
    const double extra =
        rotor ? estimator.rotor_extra_sigma_rad[static_cast<std::size_t>(encoder.counter - 2)]
              : 0.0;
    R(encoder.counter) = q * q / 12.0 + extra * extra;
  }
  for (Eigen::Index i = 0; i < flex; ++i) {
    const Eigen::Index link = i / (flex / 2), mode = i % (flex / 2);
    const double sigma = estimator.modal_sigma_m[static_cast<std::size_t>(2 * link + mode)];
    R(4 + i) = sigma * sigma;
  }
  return R;
}

// G: generalised forces on all degrees of freedom.
Eigen::MatrixXd ForceMatrix(const NominalModel& nominal, Eigen::Index states) {
  const Eigen::Index dof = nominal.M.rows();
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(states, dof);
  G.middleRows(dof, dof) = nominal.M.llt().solve(Eigen::MatrixXd::Identity(dof, dof));
  return G;
}

Eigen::MatrixXd ProcessNoise(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                             const EstimatorConfig& estimator, double period_s) {
  const Eigen::MatrixXd G_d = ZeroOrderHold(A, G, period_s).B;
  Eigen::VectorXd sigma(G_d.cols());
  const Eigen::Index modes = (G_d.cols() - 2) / 2;
  for (Eigen::Index i = 0; i < 2; ++i) {
    sigma(i) = estimator.process_force[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < modes; ++j) {
      sigma(2 + i * modes + j) = estimator.process_force[static_cast<std::size_t>(2 + 2 * i + j)];
    }
  }
  const Eigen::MatrixXd scaled = G_d * sigma.asDiagonal();
  return scaled * scaled.transpose() + kNoiseFloor * Eigen::MatrixXd::Identity(A.rows(), A.rows());
}

}  // namespace

KalmanDesign DesignKalmanFilter(const NominalModel& nominal, const SensorConfig& sensors,
                                const EstimatorConfig& estimator, double period_s) {
  const Eigen::Index n = nominal.A.rows(), flex = n / 2 - 2;
  const LinearModel system = WithGaugeFilter(nominal.A, nominal.B, 2, flex, sensors.strain_input);
  const DiscreteModel discrete = ZeroOrderHold(system.A, system.B, period_s);
  const Eigen::MatrixXd C_all = OutputMatrix(n, flex, system.A.rows());
  const Eigen::VectorXd R_all = OutputVariance(sensors, estimator, flex);

  std::vector<Eigen::Index> present;  // rows of C that the rig measures
  for (Eigen::Index row = 0; row < C_all.rows(); ++row) {
    if (row >= kCounters || (sensors.counters_present() >> row & 1u) != 0) present.push_back(row);
  }
  const Eigen::MatrixXd C = C_all(present, Eigen::all);
  const Eigen::MatrixXd R = Eigen::VectorXd(R_all(present)).asDiagonal();
  const Eigen::MatrixXd W =
      ProcessNoise(system.A, ForceMatrix(nominal, system.A.rows()), estimator, period_s);

  // The filter's Riccati equation is the controller's of the transposed system.
  const Eigen::MatrixXd A_t = discrete.A.transpose(), C_t = C.transpose();
  const Eigen::MatrixXd P = SolveDare(A_t, C_t, W, R);
  const Eigen::MatrixXd S = C * P * C_t + R;
  const Eigen::MatrixXd gain = S.llt().solve(C * P).transpose();

  KalmanDesign design{.A = discrete.A,
                      .B = discrete.B,
                      .C = C_all,
                      .L = Eigen::MatrixXd::Zero(system.A.rows(), C_all.rows()),
                      .residual = DareResidual(A_t, C_t, W, R, P)};
  for (std::size_t i = 0; i < present.size(); ++i) {
    design.L.col(present[i]) = gain.col(static_cast<Eigen::Index>(i));
  }
  return design;
}

}  // namespace flexarm
