#include "tools/bound/flexible_best.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "model/rigid_joint/quasi_static_map.h"
#include "tools/bound/fastest_plan.h"
#include "tools/bound/flexible_motion.h"
#include "tools/bound/rigid_straight.h"

namespace flexarm {
namespace {

// Durations of the starts over the straight line's. A faster start is outside the limits and is
// brought within them; which of them ends best differs from move to move.
constexpr std::array<double, 3> kStretch = {1.15, 1.3, 1.6};

int PeriodsOf(double duration_s, double period_s) {
  return std::min(static_cast<int>(std::ceil(duration_s / period_s)), kMostFlexiblePeriods);
}

// The place s of the quintic s = 10 x^3 - 15 x^4 + 6 x^5 and its derivatives by time.
RigidPoint QuinticPoint(const RestMove& move, double x, double duration_s) {
  const double s = x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
  const double s_dot = 30.0 * x * x * (1.0 - x) * (1.0 - x) / duration_s;
  const double s_ddot = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (duration_s * duration_s);
  RigidPoint point{};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double way_rad = move.to_rad[at] - move.from_rad[at];
    point.angle_rad[i] = move.from_rad[at] + s * way_rad;
    point.rate_rad_s[i] = s_dot * way_rad;
    point.acceleration_rad_s2[i] = s_ddot * way_rad;
  }
  return point;
}

TorquePlan QuasiStaticPlan(const RigidJointArm& arm, const BoundLimits& limits,
                           const RestMove& move, double duration_s, int periods) {
  TorquePlan plan{.period_s = duration_s / periods, .torque_nm = Eigen::Matrix2Xd(2, periods)};
  const OutboardBody body = arm.Outboard(move.payload_kg);
  const Eigen::Vector2d limit_nm(limits.torque_nm[0], limits.torque_nm[1]);
  for (int k = 0; k < periods; ++k) {
    const RigidPoint point = QuinticPoint(move, (k + 0.5) / periods, duration_s);
    plan.torque_nm.col(k) =
        QuasiStaticAt(arm, body, point).torque_nm.cwiseMin(limit_nm).cwiseMax(-limit_nm);
  }
  return plan;
}

MotionTrace BentTraceOf(const FastestPlan& found, const FlexibleMotion& motion,
                        const BoundLimits& limits) {
  MotionTrace trace;
  const Eigen::Index periods = found.plan.periods();
  for (Eigen::Index k = 0; k <= periods; ++k) {
    const Eigen::VectorXd x = found.x.col(k);
    const Eigen::Vector2d strain_share = (motion.shares() * x).tail<2>();
    trace.push_back(
        {.time_s = found.plan.period_s * static_cast<double>(k),
         .angle_rad = x.head<2>(),
         .rate_rad_s = x.segment<2>(6),
         .torque_nm = found.plan.torque_nm.col(std::min(k, periods - 1)),
         .strain = {strain_share[0] * limits.strain[0], strain_share[1] * limits.strain[1]}});
  }
  return trace;
}

}  // namespace

FoundMotion FlexibleBestFound(const RigidJointArm& arm, const BoundLimits& limits,
                              const RestMove& move, double period_s,
                              const std::function<void()>& progress) {
  const FlexibleMotion motion(arm, limits, move);
  const double straight_s = RigidStraight_s(arm, limits, move);
  FoundMotion best{.trace = {}, .violation = 0.0, .iterations = 0};
  for (const double stretch : kStretch) {
    const double duration_s = stretch * straight_s;
    const FastestPlan found = FindFastestPlan(
        motion, QuasiStaticPlan(arm, limits, move, duration_s, PeriodsOf(duration_s, period_s)),
        PeriodChoice::kShortest, progress);
    best.iterations += found.iterations;
    if (!found.found()) {
      if (best.trace.empty()) best.violation = found.violation;
      continue;
    }
    if (!best.trace.empty() && found.plan.duration_s() >= best.trace.back().time_s) continue;
    best.trace = BentTraceOf(found, motion, limits);
    best.violation = found.violation;
  }
  return best;
}

}  // namespace flexarm
