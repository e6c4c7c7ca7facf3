#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/law/design.h"
#include "controller/law/gain_table.h"
#include "controller/types/step_types.h"
#include "estimator/payload_knowledge.h"
#include "estimator/state_estimate.h"

namespace flexarm {

/// Torque that `sobel-settling` adds to Sobel's law while the reference rests, so that the tip
/// comes to rest although the shoulder sticks.
///
///   u <- u + w (K(m) - C_p) (x_m - x) + h,   h_1 = min(F_1, F) tanh(dth_1 / (Ts v_0)),   h_2 = 0
///
/// - K(m): gain of the table for the payload estimate and elbow angle; w grows from 0 to 1 in
///   0.1 s.
/// - h cancels the friction of the shoulder: dth_1 is the angle by which hub 1 would turn in the
///   next sample without friction, F_1 the estimated friction and F that of the config, because
///   more than the real friction would push the hub to and fro.
/// - h is off from when the energy of bending and motion is that of a vibration of the tip with
///   locked hubs of less than 1.15 mm, until it is that of more than 1.7 mm. The friction then
///   holds the arm, and a change of an encoder count does not move it.
/// Source: docs/theory/control-law.md 14. Real-time: all but the constructor is safe.
class SettleTerm {
 public:
  /// @param design  with `payload_model` and `settle_gains`, of R12
  SettleTerm(const Design& design, double friction_nm, double period_s);

  /// Start of a run.
  void Reset() noexcept;

  /// One sample. @param feedback_nm  C_p (x_m - x)  @param wanted_nm  torque of the law without
  /// adaptation  @returns the torque to add to both joints
  Eigen::Vector2d Torque(const StateVector& x, const ReferenceSample& reference,
                         const Eigen::Vector2d& feedback_nm, const Eigen::Vector2d& wanted_nm,
                         const PayloadKnowledge& payload) noexcept;

 private:
  using State = Eigen::Matrix<double, 12, 1>;

  void CountRest(const ReferenceSample& reference) noexcept;
  void JudgeVibration(const State& x) noexcept;
  double FrictionTorque(const State& x, const Eigen::Vector2d& u,
                        double estimated_nm) const noexcept;

  GainTable gains_;
  double friction_nm_, period_s_;
  Eigen::Matrix<double, 1, 12> hub_after_;        // row of A: angle of hub 1 after a sample
  Eigen::RowVector2d hub_by_torque_;              // row of B
  Eigen::Matrix<double, 6, 6> mass_, stiffness_;  // of RigidJointArm, straight
  double sway_n_per_m_;  // of the slowest vibration with locked hubs, at the tip
  double rested_s_ = 0.0;
  bool held_ = false;
};

}  // namespace flexarm
