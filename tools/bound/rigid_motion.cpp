#include "tools/bound/rigid_motion.h"

#include <Eigen/LU>

#include "tools/bound/rigid_arm.h"

namespace flexarm {
namespace {

using State = Eigen::Vector4d;

constexpr double kAngleScale_rad = 0.1, kRateScale_rad_s = 1.0;  // at the goal

State RateOf(const RigidJointArm& arm, const OutboardBody& body, const State& x,
             const Eigen::Vector2d& torque_nm) {
  const RigidForces forces = RigidForcesAt(arm, body, x.head<2>(), x.tail<2>());
  State rate;
  rate << x.tail<2>(), forces.M.inverse() * (torque_nm - forces.bias);
  return rate;
}

// One step of the classical Runge-Kutta method.
State StepOf(const RigidJointArm& arm, const OutboardBody& body, const State& x,
             const Eigen::Vector2d& torque_nm, double h) {
  const State k1 = RateOf(arm, body, x, torque_nm);
  const State k2 = RateOf(arm, body, x + 0.5 * h * k1, torque_nm);
  const State k3 = RateOf(arm, body, x + 0.5 * h * k2, torque_nm);
  const State k4 = RateOf(arm, body, x + h * k3, torque_nm);
  return x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

}  // namespace

RigidMotion::RigidMotion(const RigidJointArm& arm, const BoundLimits& limits, const RestMove& move)
    : arm_(arm),
      body_(arm.Outboard(move.payload_kg)),
      start_(State::Zero()),
      goal_(State::Zero()),
      goal_scale_(State(kAngleScale_rad, kAngleScale_rad, kRateScale_rad_s, kRateScale_rad_s)),
      shares_(Eigen::Matrix4d::Zero()),
      torque_limit_nm_(limits.rigid_torque_nm()[0], limits.rigid_torque_nm()[1]) {
  start_.head<2>() = move.from_rad;
  goal_.head<2>() = move.to_rad;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    shares_(i, i) = 1.0 / limits.hub_angle_rad[joint];
    shares_(2 + i, 2 + i) = 1.0 / limits.hub_rate_rad_s[joint];
  }
}

Eigen::VectorXd RigidMotion::Next(const Eigen::VectorXd& x, const Eigen::Vector2d& torque_nm,
                                  double period_s) const {
  return StepOf(arm_, body_, x, torque_nm, period_s);
}

}  // namespace flexarm
