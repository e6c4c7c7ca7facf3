#pragma once

#include "tools/bound/arm_motion.h"

namespace flexarm {

/// What a plan must keep, linear in small changes of it: |value + by_plan change| <= bound.
///
/// The shares of limits after each period, then the deviation from the goal over its scale, whose
/// bound is 0. Changes: torques as shares of their limits, period by
/// period, then the relative change of the period.
struct PlanRows {
  Eigen::VectorXd value, bound;
  Eigen::MatrixXd by_plan;

  /// @param x  StatesOf(arm, plan)
  PlanRows(const ArmMotion& arm, const TorquePlan& plan, const Eigen::MatrixXd& x);

  /// Values of the same rows for other states.
  static Eigen::VectorXd ValuesOf(const ArmMotion& arm, const Eigen::MatrixXd& x);
};

/// Largest excess of the states over a limit, as a share of it, or deviation from the goal over its
/// scale; 0 if there is none. Huge if the motion diverges.
double ViolationOf(const ArmMotion& arm, const Eigen::MatrixXd& x);

}  // namespace flexarm
