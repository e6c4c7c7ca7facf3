#include "controller/law/motion_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "controller/law/motion_check.h"
#include "controller/law/path_reference.h"
#include "controller/law/reference_model.h"
#include "controller/law/refused.h"
#include "controller/law/rounded_text.h"
#include "controller/law/sampling_grid.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr int kShortestMove = 10;    // periods: fewer are no smooth profile any more
constexpr double kLongest_s = 60.0;  // of a chosen duration
constexpr int kDecayPeriods = 10;    // the links of the reference go on straightening that long

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
    throw Refused(key + " is out of reach: " +
                  RoundedText(std::hypot((*move.to_tip_m)[0], (*move.to_tip_m)[1]), 4) +
                  " m from the shoulder, it must be " +
                  RoundedText(std::fabs(length_m[0] - length_m[1]), 4) + " to " +
                  RoundedText(length_m[0] + length_m[1], 4) + " m");
  }
  if (move.elbow) return *move.elbow == ElbowSide::kLeft ? *left : *right;
  const bool left_fits = Within(*left, limits), right_fits = Within(*right, limits);
  const std::string both = "elbow left " + DegText(*left) + ", right " + DegText(*right);
  if (!left_fits && !right_fits) {
    throw Refused(key + ": no angles within limits.soft_angle_deg reach it: " + both);
  }
  if (left_fits && right_fits && *left != *right) {
    throw Refused(key + " is reached by two poses: say elbow = \"left\" or \"right\": " + both);
  }
  return left_fits ? *left : *right;
}

std::array<double, 2> GoalOf(const Move& move, const std::string& row, const MotionLimits& limits) {
  if (move.to_tip_m) return AnglesOfTip(move, row, limits);
  const Eigen::Vector2d goal =
      Eigen::Vector2d(move.to_deg[0], move.to_deg[1]) * std::numbers::pi / 180.0;
  return {goal(0), goal(1)};
}

int PeriodsOf(const Move& move, const PlannedMove& planned, const Design& design, double period_s,
              const MotionLimits& limits) {
  const std::string key = RowOf(planned) + ".duration_s";
  if (move.duration_s) {
    const int periods = OnGrid(*move.duration_s, period_s, key);
    if (periods >= kShortestMove) return periods;
    throw Refused(key + " = " + NumberText(*move.duration_s) + " s must be at least " +
                  NumberText(kShortestMove) + " periods of " + NumberText(period_s) + " s");
  }
  const auto periods = ShortestPeriods(planned, design, period_s, limits, limits.plan_fraction);
  if (periods) return *periods;
  throw Refused(key + ": none up to " + NumberText(kLongest_s) +
                " s keeps limits.plan_fraction of the limits: the move goes from " +
                DegText(planned.from_rad) + " to " + DegText(planned.to_rad));
}

// The reference of a move alone, from sample 0 on: as far as limits are concerned.
std::vector<ReferenceSample> ReferenceOf(const PlannedMove& move, const Design& design,
                                         double period_s) {
  const int periods = move.periods + kDecayPeriods;
  if (design.scheduled) {
    return QuasiStaticReference(RigidPath({move}, move.from_rad, periods, period_s), ArmOf(design),
                                design.scheduled->max_kg, period_s);
  }
  std::vector<ReferenceSample> samples(static_cast<std::size_t>(periods));
  AddTorques(TorqueOf(move, design), ProfileAccelerations(move.profile, move.periods, period_s), 0,
             &samples);
  RunReferenceModel(design, move.from_rad, &samples);
  return samples;
}

}  // namespace

Eigen::Vector2d TorqueOf(const PlannedMove& move, const Design& design) {
  return design.rigid_inertia_kgm2 * (Eigen::Vector2d(move.to_rad[0], move.to_rad[1]) -
                                      Eigen::Vector2d(move.from_rad[0], move.from_rad[1]));
}

RigidPoint PlannedMove::At(double sample, double period_s) const noexcept {
  const double T = (periods - 1) * period_s;
  const ProfilePoint point = ProfileAt(profile, (sample - 0.5 - first) / (periods - 1));
  RigidPoint out{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double by_rad = to_rad[i] - from_rad[i];
    out.angle_rad[i] = from_rad[i] + by_rad * point.s;
    out.rate_rad_s[i] = by_rad * point.ds / T;
    out.acceleration_rad_s2[i] = by_rad * point.dds / (T * T);
    out.jerk_rad_s3[i] = by_rad * point.ddds / (T * T * T);
  }
  return out;
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
    place += Eigen::Vector2d(d.move_deg[0], d.move_deg[1]) * std::numbers::pi / 180.0;
  }
  return {place(0), place(1)};
}

std::optional<int> ShortestPeriods(const PlannedMove& move, const Design& design, double period_s,
                                   const MotionLimits& limits, double share) {
  const auto fits = [&](int periods) {
    PlannedMove tried = move;
    tried.first = 0;
    tried.periods = periods;
    const int states = static_cast<int>(design.Am.rows());
    return !FirstBrokenLimit(ReferenceOf(tried, design, period_s), states, limits, share, period_s)
                .has_value();
  };
  const int most = static_cast<int>(kLongest_s / period_s);
  int enough = kShortestMove;
  while (enough < most && !fits(enough)) enough = std::min(2 * enough, most);
  if (!fits(enough)) return std::nullopt;
  int too_few = enough == kShortestMove ? enough - 1 : enough / 2;
  while (enough - too_few > 1) {
    const int middle = (enough + too_few) / 2;
    (fits(middle) ? enough : too_few) = middle;
  }
  return enough;
}

std::vector<PlannedMove> PlanMoves(const Experiment& experiment, const Design& design,
                                   double period_s, const std::array<double, 2>& start_rad,
                                   const MotionLimits& limits) {
  std::vector<PlannedMove> moves;
  for (std::size_t row = 0; row < experiment.move.size(); ++row) {
    const Move& move = experiment.move[row];
    const std::string name = ProblemList::Element("move", row);
    PlannedMove planned{.row = row,
                        .first = OnGrid(move.start_s, period_s, name + ".start_s"),
                        .periods = 0,
                        .from_rad = PlaceBefore(experiment, moves, start_rad, move.start_s),
                        .to_rad = GoalOf(move, name, limits),
                        .profile = move.profile};
    planned.periods = PeriodsOf(move, planned, design, period_s, limits);
    moves.push_back(planned);
  }
  return moves;
}

std::vector<Stretch> StretchesOf(const std::vector<PlannedMove>& moves) {
  std::vector<Stretch> stretches;
  for (const PlannedMove& move : moves) {
    const int end = move.first + move.periods;
    if (stretches.empty() || move.first >= stretches.back().end) {
      stretches.push_back({.first = move.first, .end = end});
    } else {
      stretches.back().end = end;
    }
  }
  return stretches;
}

Experiment WithChosenDurations(const Experiment& experiment, const std::vector<PlannedMove>& moves,
                               double period_s) {
  Experiment chosen = experiment;
  for (const PlannedMove& planned : moves) {
    Move& move = chosen.move[planned.row];
    if (move.duration_s) continue;
    move.duration_s = std::round(planned.periods * period_s * 1e9) * 1e-9;
    chosen.text += "\n[[planned_move]]\nrow = " + NumberText(planned.row) +
                   "\nduration_s = " + NumberText(*move.duration_s) + "\n";
  }
  const std::vector<Problem> problems = chosen.Problems();
  if (problems.empty()) return chosen;
  throw Refused(problems[0].key + " = " + problems[0].value + ": " + problems[0].rule +
                " (the durations of moves without duration_s were chosen)");
}

}  // namespace flexarm
