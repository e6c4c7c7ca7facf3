#pragma once

#include <Eigen/Core>

#include "controller/law/design.h"
#include "controller/law/gain_table.h"
#include "controller/types/controller_config.h"
#include "estimator/payload_knowledge.h"
#include "estimator/state_estimate.h"
#include "model/rigid_joint/tip_sway.h"

namespace flexarm {

/// Torque that `sobel` adds to the thesis's law while the arm settles, so that the tip comes to
/// rest although the shoulder sticks.
///
///   u <- u + w (K(m) - C_p) (x_m - x) + h,   h_1 = min(F_1, F) tanh(dth_1 / (Ts v_0)),   h_2 = 0
///
/// Each part begins when the tip swings by less than its limit of [controller.settling]:
/// - K(m): gain of the table for the payload estimate and elbow angle; w grows from 0 to 1 in
///   0.1 s.
/// - h cancels the friction of the shoulder: dth_1 is the angle by which hub 1 would turn in the
///   next sample without friction, F_1 the estimated friction and F that of the config, because
///   more than the real friction would push the hub to and fro.
/// - The friction holds the arm, without h, once the tip swings by no more than asked for. So a
///   change of an encoder count does not move it.
/// Source: docs/theory/control-law.md 14. Real-time: all but the constructor is safe.
class SettleTerm {
 public:
  /// @param design  with `payload_model` and `settle_gains`, of R12
  SettleTerm(const Design& design, const SettlingConfig& config, TipSway sway, double friction_nm,
             double period_s);

  /// Start of a run.
  void Reset() noexcept;

  /// One sample. @param share  of SettlingObserver: 0 while the arm moves
  /// @param feedback_nm  C_p (x_m - x)  @param wanted_nm  torque of the law without adaptation
  /// @returns the torque to add to both joints
  Eigen::Vector2d Torque(const StateVector& x, const StateVector& x_m, double share,
                         const Eigen::Vector2d& feedback_nm, const Eigen::Vector2d& wanted_nm,
                         const PayloadKnowledge& payload) noexcept;

 private:
  using State = Eigen::Matrix<double, 12, 1>;

  void Judge(double sway_mm) noexcept;
  double FrictionTorque(const State& x, const Eigen::Vector2d& u,
                        double estimated_nm) const noexcept;

  GainTable gains_;
  SettlingConfig config_;
  double friction_nm_, period_s_;
  Eigen::Matrix<double, 1, 12> hub_after_;  // row of A: angle of hub 1 after a sample
  Eigen::RowVector2d hub_by_torque_;        // row of B
  TipSway sway_;
  double gains_share_ = 0.0;  // w
  bool compensates_ = false, held_ = false;
};

}  // namespace flexarm
