#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>

#include "controller/law/bending_guard.h"
#include "controller/law/gain_table.h"
#include "controller/law/law.h"
#include "model/rigid_joint/quasi_static_map.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// The laws `gain-scheduled` and `receding-horizon`: the arm follows a motion that leaves its tip
/// at rest, computed for the current payload estimate.
///
///   u = u_d + F tanh(theta_d' / 0.05 rad/s) + u_K + h,  u_K = K(m_K, |theta2|) (x_d - x)
///
/// - h: friction compensation of the feedback after a move, F tanh(u_K / 0.1 F), faded out linearly
///   over 4 s, none while sigma is above 0.2 of the greatest payload. It is not in the design
///   study.
/// - BendingGuard limits u_K, and u_d with its friction.
/// - x_d, u_d: of the plan (horizon_plan.h) if there is one, else the quasi-static motion in closed
///   form for the payload estimate, on which the links bend without vibration.
/// - K: of the gain table at m_K = SchedulingPayload. An estimate at its bound counts as fully
///   uncertain, as the payload may be heavier.
/// Source: docs/theory/payload.md 4.1 and 5. Real-time: all but the constructor is safe.
class ScheduledLaw final : public Law {
 public:
  using State = Eigen::Matrix<double, 12, 1>;

  /// @param payload_max_kg  the greatest payload, > 0; the gain table may end before it
  ScheduledLaw(RigidJointArm arm, GainTable gains, BendingGuard guard, double payload_max_kg,
               double period_s, const std::array<double, 2>& torque_limit_nm)
      : arm_(std::move(arm)),
        gains_(std::move(gains)),
        guard_(guard),
        payload_max_kg_(payload_max_kg),
        period_s_(period_s),
        torque_limit_nm_(torque_limit_nm) {}

  void Reset() noexcept override {}  // no internal state
  LawOutput Compute(const LawInput& input) noexcept override;

  /// x_d and u_d in closed form: QuasiStaticOver.
  /// @param path  one period before, at and after the instant at which the torque acts
  MotionSample ClosedForm(double payload_kg, const std::array<RigidPoint, 3>& path) const noexcept {
    return QuasiStaticOver(arm_, payload_kg, path, period_s_);
  }

  /// @param x         state at the instant at which the torque acts, as RigidJointArm's q, q'
  /// @param desired   x_d and u_d of that instant, without friction
  /// @param rested_s  time since the last move ended, infinite before the first; 0 during one
  /// @returns the torque, not clipped
  Eigen::Vector2d Torque(const State& x, const PayloadKnowledge& knowledge,
                         const MotionSample& desired, double rested_s) const noexcept;

 private:
  RigidJointArm arm_;
  GainTable gains_;
  BendingGuard guard_;
  double payload_max_kg_;
  double period_s_;
  std::array<double, 2> torque_limit_nm_;
};

}  // namespace flexarm
