#include "tools/bound/rigid_free.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "tools/bound/fastest_plan.h"
#include "tools/bound/rigid_motion.h"
#include "tools/bound/rigid_straight.h"

namespace flexarm {
namespace {

// The torques of a motion in the middles of equal periods.
TorquePlan SampledPlan(const MotionTrace& trace, int periods) {
  TorquePlan plan{.period_s = trace.back().time_s / periods,
                  .torque_nm = Eigen::Matrix2Xd(2, periods)};
  std::size_t at = 0;
  for (int k = 0; k < periods; ++k) {
    const double time_s = (k + 0.5) * plan.period_s;
    while (trace[at + 1].time_s < time_s) ++at;
    plan.torque_nm.col(k) = trace[at].torque_nm;
  }
  return plan;
}

// Starts of the search: the torques of the straight line, and those with the elbow's replaced by
// outwards, inwards, outwards, or the reverse. From one start alone some moves stay 1.5 % slower.
std::array<TorquePlan, 3> StartsOf(const TorquePlan& straight, double elbow_nm) {
  std::array<TorquePlan, 3> starts = {straight, straight, straight};
  const Eigen::Index periods = straight.periods();
  for (Eigen::Index k = 0; k < periods; ++k) {
    const double torque_nm = 4 * k < periods || 4 * k >= 3 * periods ? elbow_nm : -elbow_nm;
    starts[1].torque_nm(1, k) = torque_nm;
    starts[2].torque_nm(1, k) = -torque_nm;
  }
  return starts;
}

MotionTrace TraceOf(const FastestPlan& found, const BoundLimits& limits) {
  MotionTrace trace;
  const Eigen::Index periods = found.plan.periods();
  for (Eigen::Index k = 0; k <= periods; ++k) {
    const Eigen::Vector4d x = found.x.col(k);
    const Eigen::Vector2d torque_nm = found.plan.torque_nm.col(std::min(k, periods - 1));
    trace.push_back({.time_s = found.plan.period_s * static_cast<double>(k),
                     .angle_rad = x.head<2>(),
                     .rate_rad_s = x.tail<2>(),
                     .torque_nm = torque_nm,
                     .strain = RigidStrain(torque_nm, limits)});
  }
  return trace;
}

}  // namespace

FoundMotion RigidFreeMotion(const RigidJointArm& arm, const BoundLimits& limits,
                            const RestMove& move, const std::function<void()>& progress) {
  const RigidMotion motion(arm, limits, move);
  FoundMotion best{
      .trace = RigidStraightMotion(arm, limits, move), .violation = 0.0, .iterations = 0};
  const TorquePlan straight = SampledPlan(best.trace, kFreePeriods);
  for (const TorquePlan& start : StartsOf(straight, limits.rigid_torque_nm()[1])) {
    const FastestPlan found = FindFastestPlan(motion, start, PeriodChoice::kShortest, progress);
    best.iterations += found.iterations;
    if (!found.found() || found.plan.duration_s() >= best.trace.back().time_s) continue;
    best.trace = TraceOf(found, limits);
    best.violation = found.violation;
  }
  return best;
}

}  // namespace flexarm
