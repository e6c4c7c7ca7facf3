#include "controller/reference/shortest_move.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "controller/reference/motion_check.h"
#include "controller/reference/path_check.h"
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
    return !PathCheck(design, limits, share, period_s).First(path, 0, samples);
  }
  std::vector<ReferenceSample> reference(static_cast<std::size_t>(samples));
  AddTorques(TorqueOf(move, design), ProfileAccelerations(move.profile, periods, period_s), 0,
             &reference);
  RunReferenceModel(design, move.from.angle_rad, &reference);
  const int states = static_cast<int>(design.Am.rows());
  return !FirstBrokenLimit(reference, states, limits, share, period_s);
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
  RetargetSearch(std::span<const PlannedMove> moves, const PathCheck& check, double period_s)
      : moves_(moves.begin(), moves.end()), check_(check), period_s_(period_s) {
    // Two samples of the previous path are enough.
    const int earlier = moves_.back().first - kFirst;
    for (PlannedMove& move : moves_) move.first -= earlier;
  }

  // A limit that one duration breaks is mostly broken by the next one too, a little later: that
  // part of the path is checked first.
  bool Fits(int periods) {
    moves_.back().periods = periods;
    const int last = kFirst + periods + 1;
    const RigidPath path(moves_, moves_.front().from.angle_rad, last, period_s_);
    auto broken =
        check_.First(path, std::max(broken_ - kNear, kFirst), std::min(broken_ + kNear, last));
    if (!broken) broken = check_.First(path, kFirst, last);
    if (broken) broken_ = broken->sample;
    return !broken;
  }

 private:
  static constexpr int kFirst = 2, kNear = 2;

  std::vector<PlannedMove> moves_;
  const PathCheck& check_;
  double period_s_;
  int broken_ = kFirst;
};

}  // namespace

std::optional<int> ShortestPeriods(std::span<const PlannedMove> moves, const Design& design,
                                   double period_s, const MotionLimits& limits, double share) {
  const int most = MostPeriods(period_s);
  if (!moves.back().retargets) {
    return ShortestByHalving(most, [&](int periods) {
      return FitsFromRest(moves.back(), periods, design, period_s, limits, share);
    });
  }
  const PathCheck check(design, limits, share, period_s);
  RetargetSearch move(moves, check, period_s);
  for (int periods = kFewestPeriods; periods <= most; ++periods) {
    if (move.Fits(periods)) return periods;
  }
  return std::nullopt;
}

}  // namespace flexarm
