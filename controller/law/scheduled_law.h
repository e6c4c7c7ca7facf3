#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>

#include "controller/law/gain_table.h"
#include "controller/law/law.h"
#include "model/rigid_joint/quasi_static_map.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// The laws `gain-scheduled` and `receding-horizon`: the arm is led along a motion that leaves its
/// tip at rest, for the payload that is known by now.
///
///   u = u_d + F tanh(theta_d' / 0.05 rad/s) + u_K + h,  u_K = K(m_K, |theta2|) (x_d - x)
///
/// h helps u_K over the joints' friction in the two seconds after a move, 0.7 F tanh(u_K / 0.5 F)
/// less and less; it is not in the design study, and takes a fifth to a quarter of the tip's motion
/// then. x_d and u_d: in closed form for the payload found, the way on which the arm bends without
/// vibrating; or of a plan (horizon_plan.h). K from the gain table at SchedulingPayload, for which
/// a payload at its bound is wholly uncertain: it may be heavier. Source:
/// docs/theory/payload.md 4.1 and 5. Real-time: all but the constructor is safe.
class ScheduledLaw final : public Law {
 public:
  using State = Eigen::Matrix<double, 12, 1>;

  ScheduledLaw(RigidJointArm arm, GainTable gains, double period_s,
               const std::array<double, 2>& torque_limit_nm)
      : arm_(std::move(arm)),
        gains_(std::move(gains)),
        period_s_(period_s),
        torque_limit_nm_(torque_limit_nm) {}

  void Reset() noexcept override {}  // it learns nothing
  LawOutput Compute(const LawInput& input) noexcept override;

  /// x_d and u_d in closed form: QuasiStaticOver.
  /// @param path  one period before the instant the torque acts, then, and one after
  QuasiStaticSample ClosedForm(double payload_kg,
                               const std::array<RigidPoint, 3>& path) const noexcept {
    return QuasiStaticOver(arm_, payload_kg, path, period_s_);
  }

  /// @param x         of the arm at the instant the torque acts, as RigidJointArm's q, q'
  /// @param desired   x_d and u_d then, without friction
  /// @param rested_s  since the last move ended, infinite before the first; 0 while one lasts
  /// @returns the torque, not clipped
  Eigen::Vector2d Torque(const State& x, const PayloadKnowledge& knowledge,
                         const QuasiStaticSample& desired, double rested_s) const noexcept;

 private:
  RigidJointArm arm_;
  GainTable gains_;
  double period_s_;
  std::array<double, 2> torque_limit_nm_;
};

}  // namespace flexarm
