#include "controller/reference/motion_change.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/reference/motion_plan.h"
#include "controller/reference/path_check.h"
#include "controller/reference/shortest_move.h"
#include "controller/types/rejected_error.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

// A change of speed bends the links as a move does: in less than a second a light arm vibrates, and
// the hubs turn back visibly; in more than five it is no answer to a command.
constexpr double kShortestRamp_s = 1.0, kLongestRamp_s = 5.0;

void RequireChange(const ReferenceTable& table) {
  if (const std::string why = WhyNoChange(table); !why.empty()) throw RejectedError(why);
}

// Whether the path keeps the limits while its speed changes.
bool KeepsLimits(const PathPlan& plan, const ReferenceTable& table, int from,
                 const PathCheck& check) {
  constexpr int kBefore = 2;
  const int last = plan.time.settled() + 1;
  std::vector<RigidPoint> points;
  for (int k = from - kBefore; k <= last; ++k) {
    points.push_back(k < from ? table.PathAround(k)[1] : plan.At(k, table.period_s()));
  }
  const int count = static_cast<int>(points.size());
  return !check.First(RigidPath(std::move(points)), kBefore, count - 1);
}

}  // namespace

std::string WhyNoChange(const ReferenceTable& table) {
  if (!table.path_plan()) {
    return "the law of this run does not follow a path: its motion cannot be changed while it "
           "runs; controller.name = \"gain-scheduled\" or \"receding-horizon\" can";
  }
  for (const PlannedMove& move : table.path_plan()->moves) {
    if (!move.choice) continue;
    return ProblemList::Element("move", move.row) +
           ": its duration is chosen while it runs, so what follows cannot be checked before; give "
           "it duration_s, or leave out same_load";
  }
  return {};
}

int FirstChange(const ReferenceTable& table, int sample, int ahead) noexcept {
  const int settled = table.path_plan()->time.settled();
  // A paused run stays at the sample at which it came to rest.
  if (table.path_plan()->time.speed() == 0.0) return table.holds_at() + kChangeLead;
  return std::max(sample + ahead, settled);
}

ReferenceTable AtSpeed(const ReferenceTable& table, double speed, const Design& design,
                       const MotionLimits& limits) {
  RequireChange(table);
  PathPlan plan = *table.path_plan();
  plan.time = PathTime(speed);
  return {table, 0, std::move(plan), design, limits};
}

ReferenceTable WithSpeed(const ReferenceTable& table, int from, double speed, const Design& design,
                         const MotionLimits& limits) {
  RequireChange(table);
  const double period_s = table.period_s();
  const PathCheck check(design, limits, LimitShares::Of(1.0), period_s);
  const int most = static_cast<int>(std::lround(kLongestRamp_s / period_s));
  for (int n = std::max(2, static_cast<int>(std::lround(kShortestRamp_s / period_s))); n <= most;
       n += std::max(1, n / 8)) {
    PathPlan plan = *table.path_plan();
    plan.time = plan.time.WithSpeed(from, speed, n);
    if (!KeepsLimits(plan, table, from, check)) continue;
    return {table, from, std::move(plan), design, limits};
  }
  throw RejectedError("no change of the speed within " + NumberText(kLongestRamp_s) +
                      " s keeps the limits here: repeat the command, or stop the run");
}

ReferenceTable Retargeted(const ReferenceTable& table, int from, const Move& goal,
                          const Design& design, const MotionLimits& limits) {
  RequireChange(table);
  const double period_s = table.period_s();
  const PathPlan& old = *table.path_plan();
  const double now = old.time.At(from).periods;
  PlannedMove move{.row = 0,
                   .first = from,
                   .periods = 0,
                   .retargets = true,
                   .from = old.AtPathTime(now, period_s),
                   .to_rad = GoalOf(goal, "retarget", limits),
                   .profile = goal.profile,
                   .same_load = true};
  if (goal.duration_s) {
    move.periods = GivenPeriods(*goal.duration_s, period_s, "retarget.duration_s");
  } else {
    const std::optional<int> shortest =
        ShortestRetarget({old.AtPathTime(now - 2.0, period_s), old.AtPathTime(now - 1.0, period_s)},
                         move, design, period_s, limits, limits.plan_fraction);
    if (!shortest) {
      throw RejectedError("retarget: no duration up to " + NumberText(kLongestChosen_s) +
                          " s keeps limits.plan_fraction of the limits on the way there");
    }
    move.periods = *shortest;
  }
  PathPlan plan{.moves = {move},
                .start_rad = move.from.angle_rad,
                .end = from + move.periods + std::ceil(kRestAfterRows_s / period_s),
                .time = old.time.CountedFrom(from)};
  return {table, from, std::move(plan), design, limits};
}

}  // namespace flexarm
