#include "controller/design/design_at_payload.h"

#include "controller/design/straight_arm_model.h"
#include "estimator/kalman_design.h"
#include "model/math/discretize.h"

namespace flexarm {
namespace {

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
  const NominalModel model = StraightArmModel(MakeRigidJointArm(design), payload_kg, theta2_rad);
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
