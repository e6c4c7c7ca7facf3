#pragma once

#include <functional>

#include "tools/bound/arm_motion.h"

namespace flexarm {

/// What the search does with the period of a plan.
enum class PeriodChoice {
  kShortest,  ///< makes it as short as the limits permit
  kKept,      ///< keeps it, and only brings the motion within the limits
};

struct FastestPlan {
  TorquePlan plan;
  Eigen::MatrixXd x;  ///< StatesOf
  /// Largest excess over a limit, as a share of it, or over the goal's scale; the torques keep
  /// their limits exactly.
  double violation;
  int iterations;  ///< linear programs solved

  static constexpr double kMostViolation = 0.002;  ///< of a plan that counts as found
  bool found() const { return violation <= kMostViolation; }
};

/// Fastest motion from rest to rest, by sequential linear programming.
///
/// Around the present plan the motion is linear in the changes of the torques and of the period;
/// the linear program of their best values within a trust region is solved, and taken if the merit
///   period / first period + weight max(0, largest violation)
/// falls. The region then grows or shrinks. Torques of the fastest motion are at limits nearly all
/// the time, as a linear program's solution is; so few iterations are needed. It ends in a local
/// optimum, which is not proven to be the best.
/// Source: Fletcher, Practical Methods of Optimization, chapter 14 (Sl1LP, here with the largest
/// violation). docs/theory/bound.md 3.
/// @param progress  called after each linear program; may be empty
FastestPlan FindFastestPlan(const ArmMotion& arm, const TorquePlan& start, PeriodChoice choice,
                            const std::function<void()>& progress = {});

}  // namespace flexarm
