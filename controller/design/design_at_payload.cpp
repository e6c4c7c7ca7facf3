#include "controller/design/design_at_payload.h"

#include "estimator/kalman_design.h"
#include "estimator/nominal_model.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/math/library_math.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {
namespace {

// The arm with rigid joints at rest, its links straight: M q'' + D q' + K q = [u; 0].
NominalModel ModelAt(const RigidJointArm& arm, double payload_kg, double theta2_rad) {
  constexpr Eigen::Index n = RigidJointArm::kDof;
  const RigidJointArm::Vector q = theta2_rad * RigidJointArm::Vector::Unit(1);
  NominalModel model{
      .layout = kR12,
      .M = arm.At<LibraryMath>(arm.Outboard(payload_kg), q, RigidJointArm::Vector::Zero()).M,
      .D = arm.damping(),
      .K = arm.stiffness(),
      .A = Eigen::MatrixXd::Zero(2 * n, 2 * n),
      .B = Eigen::MatrixXd::Zero(2 * n, 2),
      .torque_mode_rad_s = {}};
  const Eigen::MatrixXd M_inverse = model.M.llt().solve(Eigen::MatrixXd::Identity(n, n));
  model.A.topRightCorner(n, n).setIdentity();
  model.A.bottomLeftCorner(n, n) = -M_inverse * model.K;
  model.A.bottomRightCorner(n, n) = -M_inverse * model.D;
  model.B.bottomRows(n) = M_inverse.leftCols(2);
  return model;
}

// The Kalman filter with the noises of `ekf-payload`.
EstimatorConfig AsKalman(EstimatorConfig estimator) {
  estimator.process_force = estimator.payload->process_force;
  estimator.rotor_extra_sigma_rad = estimator.payload->rotor_extra_sigma_rad;
  return estimator;
}

}  // namespace

Design DesignAtPayload(const ControlConfig& config, const Design& design, double payload_kg,
                       double theta2_rad) {
  const double period_s = config.loop.period_s();
  const NominalModel model = ModelAt(MakeRigidJointArm(design), payload_kg, theta2_rad);
  const DiscreteModel plant = ZeroOrderHold(model.A, model.B, period_s);
  const KalmanDesign filter =
      DesignKalmanFilter(model, config.arm, config.sensors, AsKalman(config.estimator), period_s);
  Design at = design;
  at.A = plant.A;
  at.B = plant.B;
  at.A_rate = model.A;
  at.B_rate = model.B;
  at.K = design.scheduled->gains.At(payload_kg, theta2_rad);
  at.filter_A = filter.A;
  at.filter_B = filter.B;
  at.filter_C = filter.C;
  at.filter_L = filter.L;
  at.filter_A_rate = filter.A_rate;
  at.filter_B_rate = filter.B_rate;
  return at;
}

}  // namespace flexarm
