#include "tools/bound/flexible_motion.h"

#include <cstddef>

#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {
namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;

constexpr double kAnyGauge_hz = 1.0;  // the gauges' filters do not matter here; any value
// Deviations from the goal that count as a limit: rad, m, rad/s, m/s.
constexpr double kAngle_rad = 0.1, kBend_m = 0.05, kRate_rad_s = 1.0, kBendRate_m_s = 0.5;

}  // namespace

FlexibleMotion::FlexibleMotion(const RigidJointArm& arm, const BoundLimits& limits,
                               const RestMove& move)
    : arm_(arm),
      payload_kg_(move.payload_kg),
      start_(Vector12::Zero()),
      goal_(Vector12::Zero()),
      goal_scale_(12),
      shares_(Eigen::MatrixXd::Zero(6, 12)),
      torque_limit_nm_(limits.torque_nm[0], limits.torque_nm[1]) {
  start_.head<2>() = move.from_rad;
  goal_.head<2>() = move.to_rad;
  goal_scale_ << Eigen::Vector2d::Constant(kAngle_rad), Eigen::Vector4d::Constant(kBend_m),
      Eigen::Vector2d::Constant(kRate_rad_s), Eigen::Vector4d::Constant(kBendRate_m_s);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    shares_(i, i) = 1.0 / limits.hub_angle_rad[at];
    shares_(2 + i, 6 + i) = 1.0 / limits.hub_rate_rad_s[at];
    for (Eigen::Index mode = 0; mode < 2; ++mode) {
      shares_(4 + i, 2 + 2 * i + mode) =
          limits.root_strain_per_m[at][static_cast<std::size_t>(mode)] / limits.strain[at];
    }
  }
}

Eigen::VectorXd FlexibleMotion::Next(const Eigen::VectorXd& x, const Eigen::Vector2d& torque_nm,
                                     double period_s) const {
  const RigidJointStepper stepper(arm_, period_s, kAnyGauge_hz);
  const GaugedState state = stepper.Advance(
      {.q = x.head<6>(), .v = x.tail<6>(), .phi_f = Eigen::Vector4d::Zero()},
      {.torque_nm = torque_nm, .payload_kg = payload_kg_, .friction_nm = {0.0, 0.0}});
  return (Vector12() << state.q, state.v).finished();
}

}  // namespace flexarm
