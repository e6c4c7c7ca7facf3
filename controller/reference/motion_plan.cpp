#include "controller/reference/motion_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "controller/reference/sampling_grid.h"
#include "controller/reference/shortest_move.h"
#include "controller/types/rejected_error.h"
#include "controller/types/rounded_text.h"
#include "model/problem_list.h"
#include "model/units.h"

namespace flexarm {
namespace {

std::string RowOf(const PlannedMove& move) { return ProblemList::Element("move", move.row); }

std::string DegText(const std::array<double, 2>& angle_rad) {
  std::string text = "[";
  text += RoundedText(angle_rad[0] / kRadPerDeg, 1, true);
  text += ", ";
  text += RoundedText(angle_rad[1] / kRadPerDeg, 1, true);
  return text + "] deg";
}

bool Within(const std::array<double, 2>& angle_rad, const MotionLimits& limits) {
  return std::fabs(angle_rad[0]) <= limits.soft_angle_rad[0] &&
         std::fabs(angle_rad[1]) <= limits.soft_angle_rad[1];
}

std::array<double, 2> AnglesOfTip(const Move& move, const std::string& row,
                                  const MotionLimits& limits) {
  const auto& length_m = limits.link_length_m;
  const std::string key = row + ".to_tip_m = [" + NumberText((*move.to_tip_m)[0]) + ", " +
                          NumberText((*move.to_tip_m)[1]) + "]";
  const auto left = StraightArmAngles(length_m, *move.to_tip_m, ElbowSide::kLeft);
  const auto right = StraightArmAngles(length_m, *move.to_tip_m, ElbowSide::kRight);
  if (!left || !right) {
    throw RejectedError(key + " is out of reach: " +
                        RoundedText(std::hypot((*move.to_tip_m)[0], (*move.to_tip_m)[1]), 4) +
                        " m from the shoulder, it must be " +
                        RoundedText(std::fabs(length_m[0] - length_m[1]), 4) + " to " +
                        RoundedText(length_m[0] + length_m[1], 4) + " m");
  }
  if (move.elbow) return *move.elbow == ElbowSide::kLeft ? *left : *right;
  const bool left_fits = Within(*left, limits), right_fits = Within(*right, limits);
  const std::string both = "elbow left " + DegText(*left) + ", right " + DegText(*right);
  if (!left_fits && !right_fits) {
    throw RejectedError(key + ": no joint angles within limits.soft_angle_deg reach it: " + both);
  }
  if (left_fits && right_fits && *left != *right) {
    throw RejectedError(key +
                        " is reached by two poses: set elbow = \"left\" or \"right\": " + both);
  }
  return left_fits ? *left : *right;
}

// Start of a move, for a message that continues with "to".
std::string BeginText(const PlannedMove& move) {
  if (!move.retargets) return "the move goes from " + DegText(move.from.angle_rad);
  return "the move retargets at " + DegText(move.from.angle_rad) + " and " +
         DegText(move.from.rate_rad_s) + " per second, and goes";
}

// Whether the payload at a move is that of the move before it: no announced change since.
bool KeepsLoad(const Experiment& experiment, std::size_t row) {
  if (!experiment.move[row].same_load) return false;
  const double until_s = experiment.move[row].start_s;
  const double since_s = row == 0 ? 0.0 : experiment.move[row - 1].start_s;
  return std::none_of(
      experiment.load_change.begin(), experiment.load_change.end(),
      [&](const LoadChange& change) { return change.at_s >= since_s && change.at_s <= until_s; });
}

[[noreturn]] void RefuseForLimits(const PlannedMove& planned, const std::string& share,
                                  const MotionLimits& limits) {
  if (!Within(planned.to_rad, limits)) {
    throw RejectedError(RowOf(planned) + ": its end at " + DegText(planned.to_rad) +
                        " is beyond limits.soft_angle_deg, " + DegText(limits.soft_angle_rad));
  }
  throw RejectedError(RowOf(planned) + ".duration_s: no duration up to " +
                      NumberText(kLongestChosen_s) + " s keeps " + share +
                      " of the limits: " + BeginText(planned) + " to " + DegText(planned.to_rad));
}

// The number of periods of the last of `moves`, whose other members are set.
int PeriodsOf(const Move& move, const std::vector<PlannedMove>& moves, const Design& design,
              double period_s, const MotionLimits& limits) {
  const PlannedMove& planned = moves.back();
  const std::string key = RowOf(planned) + ".duration_s";
  if (move.duration_s) {
    return GivenPeriods(*move.duration_s, period_s, key);
  }
  const auto periods = ShortestPeriods(moves, design, period_s, limits, limits.plan_fraction);
  if (!periods) RefuseForLimits(planned, "limits.plan_fraction", limits);
  return *periods;
}

// Sets the durations of a move `duration = "shortest"`. Where its payload is that of the move
// before, the run chooses among them; otherwise every payload must be possible. A law that plans
// ahead needs to know the end of a move before it begins.
void Shorten(const Move& move, const Design& design, double period_s, const MotionLimits& limits,
             PlannedMove* planned) {
  std::optional<DurationTable> table = ShortestByPayload(*planned, design, period_s, limits);
  if (!table) RefuseForLimits(*planned, "controller.payload.fast_fraction", limits);
  planned->periods = move.duration_s
                         ? OnGrid(*move.duration_s, period_s, RowOf(*planned) + ".duration_s")
                         : table->Longest();
  planned->is_shortest = true;
  const bool plans_ahead = design.scheduled->start_gains.has_value();
  if (!planned->same_load || plans_ahead) return;
  table->LimitTo(planned->periods);
  planned->choice = table;
}

void RequireTakeOver(const PlannedMove& planned, const PlannedMove& above, const Design& design,
                     double period_s) {
  if (design.scheduled) return;
  throw RejectedError(RowOf(planned) +
                      ".start_s = " + NumberText(InSeconds(planned.first, period_s)) +
                      " s: must not begin before the move above it ends, at " +
                      NumberText(InSeconds(above.first + above.periods, period_s)) +
                      " s; only a law that follows a path can retarget during a move: "
                      "controller.name = \"gain-scheduled\" or \"receding-horizon\"");
}

// Whether a move that begins at sample `first` begins before the last of `moves` ends.
bool Retargets(const std::vector<PlannedMove>& moves, int first) {
  return !moves.empty() && first < moves.back().first + moves.back().periods;
}

}  // namespace

int GivenPeriods(double duration_s, double period_s, const std::string& key) {
  const int periods = OnGrid(duration_s, period_s, key);
  if (periods >= kFewestPeriods) return periods;
  throw RejectedError(key + " = " + NumberText(duration_s) + " s must be at least " +
                      NumberText(kFewestPeriods) + " periods of " + NumberText(period_s) + " s");
}

std::array<double, 2> GoalOf(const Move& move, const std::string& row, const MotionLimits& limits) {
  if (move.to_tip_m) return AnglesOfTip(move, row, limits);
  const Eigen::Vector2d goal =
      Eigen::Vector2d(RadFromDeg(move.to_deg[0]), RadFromDeg(move.to_deg[1]));
  return {goal(0), goal(1)};
}

std::array<double, 2> PlaceBefore(const Experiment& experiment,
                                  const std::vector<PlannedMove>& moves,
                                  const std::array<double, 2>& start_rad, double start_s) {
  Eigen::Vector2d place(start_rad[0], start_rad[1]);
  double since_s = -std::numeric_limits<double>::infinity();
  for (const PlannedMove& move : moves) {
    if (experiment.move[move.row].start_s >= start_s) break;
    since_s = experiment.move[move.row].start_s;
    place << move.to_rad[0], move.to_rad[1];
  }
  if (experiment.csv && experiment.csv->start_s < start_s && experiment.csv->start_s > since_s) {
    since_s = experiment.csv->start_s;
    const auto& end_rad = experiment.csv->point.back().angle_rad;
    place << end_rad[0], end_rad[1];
  }
  for (const Doublet& d : experiment.doublet) {
    if (d.start_s <= since_s || d.start_s > start_s) continue;
    place += Eigen::Vector2d(RadFromDeg(d.move_deg[0]), RadFromDeg(d.move_deg[1]));
  }
  return {place(0), place(1)};
}

std::vector<PlannedMove> PlanMoves(const Experiment& experiment, const Design& design,
                                   double period_s, const std::array<double, 2>& start_rad,
                                   const MotionLimits& limits, const std::stop_token& stop) {
  std::vector<PlannedMove> moves;
  for (std::size_t row = 0; row < experiment.move.size(); ++row) {
    if (stop.stop_requested()) throw RejectedError("the planning of the experiment was cancelled");
    const Move& move = experiment.move[row];
    const std::string name = ProblemList::Element("move", row);
    PlannedMove planned{.row = row,
                        .first = OnGrid(move.start_s, period_s, name + ".start_s"),
                        .periods = 0,
                        .retargets = false,
                        .from = {},
                        .to_rad = GoalOf(move, name, limits),
                        .profile = move.profile,
                        .same_load = KeepsLoad(experiment, row)};
    if (Retargets(moves, planned.first)) {
      RequireTakeOver(planned, moves.back(), design, period_s);
      planned.retargets = true;
      planned.from = moves.back().At(planned.first, period_s);
    } else {
      planned.from.angle_rad = PlaceBefore(experiment, moves, start_rad, move.start_s);
    }
    moves.push_back(planned);
    if (move.shortest && design.scheduled && !planned.retargets) {
      Shorten(move, design, period_s, limits, &moves.back());
    } else {
      moves.back().periods = PeriodsOf(move, moves, design, period_s, limits);
    }
  }
  return moves;
}

std::vector<MotionSegment> MotionSegmentsOf(const std::vector<PlannedMove>& moves) {
  std::vector<MotionSegment> segments;
  for (const PlannedMove& move : moves) {
    const int end = move.first + move.periods;
    if (segments.empty() || move.first >= segments.back().end) {
      segments.push_back({.first = move.first, .end = end});
    } else {
      segments.back().end = end;
    }
  }
  return segments;
}

Experiment WithChosenDurations(const Experiment& experiment, const std::vector<PlannedMove>& moves,
                               double period_s) {
  Experiment chosen = experiment;
  for (const PlannedMove& planned : moves) {
    Move& move = chosen.move[planned.row];
    if (move.duration_s) continue;
    move.duration_s = InSeconds(planned.periods, period_s);
    chosen.text += "\n[[planned_move]]\nrow = " + NumberText(planned.row) +
                   "\nduration_s = " + NumberText(*move.duration_s) + "\n";
  }
  if (chosen.ends_after_rows) {
    chosen.ends_after_rows = false;
    double rows_end_s = 0.0;
    for (const Motion& motion : chosen.Motions()) {
      rows_end_s = std::max(rows_end_s, motion.start_s + motion.duration_s);
    }
    const double end_s = std::min(rows_end_s + kRestAfterRows_s, kLongestRun_s);
    chosen.duration_s = InSeconds(static_cast<int>(std::ceil(end_s / period_s - 1e-6)), period_s);
    chosen.text += "\n[planned]\nduration_s = " + NumberText(chosen.duration_s) + "\n";
  }
  const std::vector<Problem> problems = chosen.Problems();
  if (problems.empty()) return chosen;
  throw RejectedError(problems[0].key + " = " + problems[0].value + ": " + problems[0].rule +
                      " (with the durations chosen for moves without duration_s)");
}

}  // namespace flexarm
