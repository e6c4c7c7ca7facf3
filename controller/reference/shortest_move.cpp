#include "controller/reference/shortest_move.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "controller/reference/motion_check.h"
#include "controller/reference/path_check.h"
#include "controller/reference/path_plan.h"
#include "controller/reference/reference_model.h"

namespace flexarm {
namespace {

constexpr int kDecayPeriods = 10;  // duration in which the links of the reference straighten

int MostPeriods(double period_s) { return static_cast<int>(kLongestChosen_s / period_s); }

// Whether a move from rest keeps the limits, without regard to other moves.
bool FitsFromRest(PlannedMove move, int periods, const Design& design, double period_s,
                  const MotionLimits& limits, double share) {
  move.first = 0;
  move.periods = periods;
  const int samples = periods + kDecayPeriods;
  if (design.scheduled) {
    const RigidPath path({&move, 1}, move.from.angle_rad, samples, period_s);
    return !PathCheck(design, limits, LimitShares::Of(share), period_s).First(path, 0, samples);
  }
  std::vector<ReferenceSample> reference(static_cast<std::size_t>(samples));
  AddTorques(TorqueOf(move, design), ProfileAccelerations(move.profile, periods, period_s), 0,
             &reference);
  RunReferenceModel(design, move.from.angle_rad, &reference);
  const int states = static_cast<int>(design.Am.rows());
  return !FirstBrokenLimit(reference, states, limits, LimitShares::Of(share), period_s);
}

template <typename Fits>
std::optional<int> ShortestByHalving(int most, const Fits& fits) {
  int enough = kFewestPeriods;
  while (enough < most && !fits(enough)) enough = std::min(2 * enough, most);
  if (!fits(enough)) return std::nullopt;
  int too_few = enough == kFewestPeriods ? enough - 1 : enough / 2;
  while (enough - too_few > 1) {
    const int middle = (enough + too_few) / 2;
    (fits(middle) ? enough : too_few) = middle;
  }
  return enough;
}

// Tests durations of a move that retargets.
class RetargetSearch {
 public:
  RetargetSearch(const std::array<RigidPoint, 2>& before, const PlannedMove& move,
                 const PathCheck& check, double period_s)
      : before_(before), move_(move), check_(check), period_s_(period_s) {
    move_.first = kFirst;
  }

  // A limit that one duration breaks is mostly broken by the next one too, a little later: that
  // part of the path is checked first.
  bool Fits(int periods) {
    move_.periods = periods;
    const int last = kFirst + periods + 1;
    std::vector<RigidPoint> points(before_.begin(), before_.end());
    for (int k = kFirst; k <= last; ++k) points.push_back(move_.At(k, period_s_));
    const RigidPath path(std::move(points));
    auto broken =
        check_.First(path, std::max(broken_ - kNear, kFirst), std::min(broken_ + kNear, last));
    if (!broken) broken = check_.First(path, kFirst, last);
    if (broken) broken_ = broken->sample;
    return !broken;
  }

 private:
  static constexpr int kFirst = 2, kNear = 2;

  std::array<RigidPoint, 2> before_;
  PlannedMove move_;
  const PathCheck& check_;
  double period_s_;
  int broken_ = kFirst;
};

// Rates have a larger share: a rate just reached does no harm, and trips have a margin above.
constexpr double kRateShare = 0.8 / 0.72;

// The hubs of a fast move are farther from their reference than those of a slow one.
constexpr double kAngleMargin_rad = 0.05;

// Tests durations of a move from rest for one payload after the other.
class FastSearch {
 public:
  FastSearch(const PlannedMove& move, const Design& design, double period_s,
             const MotionLimits& limits)
      : move_(move), design_(design), period_s_(period_s), limits_(limits) {
    move_.first = 0;
    move_.is_shortest = true;
    for (double& angle_rad : limits_.soft_angle_rad) angle_rad -= kAngleMargin_rad;
  }

  bool Fits(double payload_kg, int periods) {
    move_.periods = periods;
    const double light = limits_.fast_fraction[0], heavy = limits_.fast_fraction[1];
    const double share = light + (heavy - light) * payload_kg / design_.scheduled->max_kg;
    const LimitShares shares = {
        .torque = share, .jump = 1.0, .rate = std::min(1.0, kRateShare * share), .strain = share};
    const RigidPath path({&move_, 1}, move_.from.angle_rad, periods + 1, period_s_);
    const PathCheck check(design_, limits_, shares, period_s_);
    return !check.FirstWith(payload_kg, path, 0, periods + 1);
  }

  // Starts from the duration of the payload before, which is near.
  std::optional<int> Shortest(double payload_kg, int near) {
    const int least = std::max(
        kFewestPeriods, static_cast<int>(std::ceil(limits_.fast_least_s / period_s_ - 1e-9)));
    int periods = std::max(near, least);
    if (Fits(payload_kg, periods)) {
      while (periods > least && Fits(payload_kg, periods - 1)) --periods;
      return periods;
    }
    const int most = MostPeriods(period_s_);
    int too_few = periods;
    while (periods < most && !Fits(payload_kg, periods)) {
      too_few = periods;
      periods = std::min(periods + periods / 4 + 1, most);
    }
    if (!Fits(payload_kg, periods)) return std::nullopt;
    while (periods - too_few > 1) {
      const int middle = (periods + too_few) / 2;
      (Fits(payload_kg, middle) ? periods : too_few) = middle;
    }
    return periods;
  }

 private:
  PlannedMove move_;
  const Design& design_;
  double period_s_;
  MotionLimits limits_;
};

}  // namespace

std::optional<DurationTable> ShortestByPayload(const PlannedMove& move, const Design& design,
                                               double period_s, const MotionLimits& limits) {
  FastSearch search(move, design, period_s, limits);
  const double max_kg = design.scheduled->max_kg;
  DurationTable::Periods periods{};
  int near = 0;
  for (std::size_t i = 0; i < periods.size(); ++i) {
    const double payload_kg = max_kg * static_cast<double>(i) / (DurationTable::kPayloads - 1);
    const std::optional<int> shortest = search.Shortest(payload_kg, near);
    if (!shortest) return std::nullopt;
    near = *shortest;
    periods[i] = static_cast<std::int16_t>(near);
  }
  return DurationTable(periods, max_kg);
}

std::optional<int> ShortestPeriods(std::span<const PlannedMove> moves, const Design& design,
                                   double period_s, const MotionLimits& limits, double share) {
  const int most = MostPeriods(period_s);
  if (!moves.back().retargets) {
    return ShortestByHalving(most, [&](int periods) {
      return FitsFromRest(moves.back(), periods, design, period_s, limits, share);
    });
  }
  const PlannedMove& last = moves.back();
  const PathPlan path{.moves = {moves.begin(), moves.end() - 1},
                      .start_rad = moves.front().from.angle_rad,
                      .end = static_cast<double>(last.first),
                      .time = PathTime(1.0)};
  return ShortestRetarget(
      {path.AtPathTime(last.first - 2, period_s), path.AtPathTime(last.first - 1, period_s)}, last,
      design, period_s, limits, share);
}

std::optional<int> ShortestRetarget(const std::array<RigidPoint, 2>& before,
                                    const PlannedMove& move, const Design& design, double period_s,
                                    const MotionLimits& limits, double share) {
  const PathCheck check(design, limits, LimitShares::Of(share), period_s);
  RetargetSearch search(before, move, check, period_s);
  for (int periods = kFewestPeriods; periods <= MostPeriods(period_s); ++periods) {
    if (search.Fits(periods)) return periods;
  }
  return std::nullopt;
}

}  // namespace flexarm
