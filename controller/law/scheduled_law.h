#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>

#include "controller/law/gain_table.h"
#include "controller/law/payload_supervisor.h"
#include "controller/law/rigid_point.h"
#include "model/rigid_joint_arm.h"

namespace flexarm {

/// The law `gain-scheduled`: the arm is led along the way on which it bends without vibrating, for
/// the payload that is known by now.
///
///   u = u_d + F tanh(theta_d' / 0.05 rad/s) + K(m_K, |theta2|) (x_d - x)
///
/// x_d and u_d by QuasiStaticOver for the payload found; K from the gain table at GainPayload, for
/// which a payload at its bound is wholly uncertain: it may be heavier.
/// Source: beyond.md 2.4 and 2.5 (A). Real-time: Torque is safe.
class ScheduledLaw {
 public:
  using State = Eigen::Matrix<double, 12, 1>;

  ScheduledLaw(RigidJointArm arm, GainTable gains, double period_s)
      : arm_(std::move(arm)), gains_(std::move(gains)), period_s_(period_s) {}

  /// @param x         of the arm at the instant the torque acts, as RigidJointArm's q, q'
  /// @param path      one period before that instant, then, and one after
  /// @param rested_s  since the last move ended; 0 while one lasts
  /// @returns the torque, not clipped
  Eigen::Vector2d Torque(const State& x, const PayloadKnowledge& knowledge,
                         const std::array<RigidPoint, 3>& path, double rested_s) const noexcept;

 private:
  RigidJointArm arm_;
  GainTable gains_;
  double period_s_;
};

}  // namespace flexarm
