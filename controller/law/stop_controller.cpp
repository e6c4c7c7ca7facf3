#include "controller/law/stop_controller.h"

#include <cmath>

namespace flexarm {
namespace {

// The goal follows the hubs with this time constant: slower than the arm's vibration (below 0.2 s
// with free joints), faster than the stop's time-out of 3 s.
constexpr double kGoalFollows_s = 0.5;

// The difference to the torque before the stop decays with this time constant: a step would excite
// the links, whose vibrations with free joints have a period of 0.15 s.
constexpr double kJumpDecays_s = 0.1;

// If the arm is not at rest after 1.8 s, the torque is ramped to zero over 0.4 s: with backlash any
// feedback causes a limit cycle, and friction brings the arm to rest.
constexpr double kNoTorqueFrom_s = 2.2, kRamp_s = 0.4;

}  // namespace

Eigen::Vector2d StopController::Regulate(const StateVector& x,
                                         const Eigen::Vector2d& hub_rad) const noexcept {
  StateVector x_goal = StateVector::Zero(layout_.states());  // unbent, joints untwisted
  for (int i = 0; i < 2; ++i) x_goal(layout_.hub(i)) = x_goal(layout_.rotor(i)) = hub_rad(i);
  return K_stop_.lazyProduct(x_goal - x);
}

void StopController::Begin(const Eigen::Vector2d& hub_rad,
                           const Eigen::Vector2d& torque_nm) noexcept {
  goal_rad_ = hub_rad;
  torque_before_nm_ = torque_nm;
  stopping_s_ = -1.0;
}

Eigen::Vector2d StopController::Stop(const StateVector& x) noexcept {
  const bool first = stopping_s_ < 0.0;
  const Eigen::Vector2d hubs(x(layout_.hub(0)), x(layout_.hub(1)));
  goal_rad_ += (period_s_ / kGoalFollows_s) * (hubs - goal_rad_);
  const Eigen::Vector2d u = Regulate(x, goal_rad_);
  if (first) jump_nm_ = torque_before_nm_ - u;
  stopping_s_ = first ? 0.0 : stopping_s_ + period_s_;
  const double ramp = std::fmin(1.0, std::fmax(0.0, (kNoTorqueFrom_s - stopping_s_) / kRamp_s));
  Eigen::Vector2d torque_nm = ramp * (u + jump_nm_);
  jump_nm_ *= 1.0 - period_s_ / kJumpDecays_s;
  return torque_nm;
}

}  // namespace flexarm
