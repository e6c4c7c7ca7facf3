// Why no law here learns from the repetitions of a move (docs/theory/fast-moves.md 6): the place at
// which the tip rests, and its motion there, differ from one repetition to the next by as much as
// they differ from the target. A correction that knows all repetitions before has little to
// correct.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "model/units.h"
#include "tests/controller/loop/stack_run.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

using Place = std::array<double, 2>;  // mm

constexpr int kPairs = 10, kRepetitions = 10;
constexpr double kEvery_s = 4.0;  // the longest of the moves takes 2.2 s
// Of the rest: its last 1.5 s. Later than 0.3 s after every move.
constexpr int kSamples = 75, kPerMove = 200;

struct Squares {
  double sum = 0.0;
  int count = 0;
  void Add(const Place& a, const Place& b) {
    sum += (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
    ++count;
  }
  double rms() const { return std::sqrt(sum / count); }
};

// The tip in the rests after one of the two moves of a pair, by repetition.
struct Rests {
  std::vector<std::vector<Place>> tip;
  Place target{};
};

Place Mean(const std::vector<Place>& tips) {
  Place mean{};
  for (const Place& tip : tips) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      mean[axis] += tip[axis] / static_cast<double>(tips.size());
  }
  return mean;
}

Experiment BackAndForth(UniformNumbers* random) {
  std::array<std::array<double, 2>, 2> place_deg{};
  for (auto& place : place_deg) place = {random->Between(-60, 60), random->Between(-80, 80)};
  Experiment experiment{};
  experiment.name = "pair";
  constexpr int kMoves = 2 * kRepetitions + 1;
  for (int i = 0; i < kMoves; ++i) {
    experiment.move.push_back({.start_s = kEvery_s * i,
                               .same_load = i > 0,
                               .to_deg = place_deg[static_cast<std::size_t>(i % 2)]});
  }
  experiment.duration_s = kEvery_s * kMoves;
  return experiment;
}

// The first move finds the payload and is left out.
std::array<Rests, 2> RestsOfPair(std::uint64_t seed) {
  UniformNumbers random(seed);
  const double payload_kg = random.Between(0.0, 1.0);
  const Experiment experiment = BackAndForth(&random);
  StackRun run(ShippedRig({"controller.name=gain-scheduled", "estimator.name=ekf-payload",
                           "sim.seed=" + std::to_string(seed)}),
               experiment, payload_kg);
  run.Run(std::llround((experiment.duration_s + 5.0) * 1e9));
  std::vector<const TickRecord*> running;
  for (const TickRecord& record : run.tick) {
    if (record.input.safety_state == SafetyState::kRunning) running.push_back(&record);
  }
  std::array<Rests, 2> rests;
  const TipGeometry geometry = TipGeometryOf(run.config());
  for (int move = 1; move <= 2 * kRepetitions; ++move) {
    Rests& after = rests[static_cast<std::size_t>(move % 2)];
    std::vector<Place>& tip = after.tip.emplace_back();
    const int end = (move + 1) * kPerMove - 2;
    for (int k = end - kSamples; k < end; ++k) {
      const TickRecord& record = *running.at(static_cast<std::size_t>(k));
      tip.push_back({1e3 * record.truth.tip_m[0], 1e3 * record.truth.tip_m[1]});
      const auto target = StraightTip(geometry, record.input.reference_now.x_m);
      after.target = {1e3 * target[0], 1e3 * target[1]};
    }
  }
  return rests;
}

TEST(RepeatedMoves, TheErrorsOfOneRepetitionAreNotThoseOfTheNext) {
  Squares error, motion, unlearnable_error, unlearnable_motion;
  for (std::uint64_t seed = 31000; seed < 31000 + kPairs; ++seed) {
    for (const Rests& rests : RestsOfPair(seed)) {
      ASSERT_EQ(rests.tip.size(), static_cast<std::size_t>(kRepetitions));
      // What a perfect student of the repetitions before the last one would predict.
      Place place{};
      std::vector<Place> course(kSamples);
      for (int n = 0; n + 1 < kRepetitions; ++n) {
        const std::vector<Place>& tip = rests.tip[static_cast<std::size_t>(n)];
        const Place mean = Mean(tip);
        error.Add(mean, rests.target);
        for (std::size_t axis = 0; axis < 2; ++axis) {
          place[axis] += mean[axis] / (kRepetitions - 1);
          for (std::size_t k = 0; k < tip.size(); ++k)
            course[k][axis] += (tip[k][axis] - mean[axis]) / (kRepetitions - 1);
        }
        for (const Place& at : tip) motion.Add(at, mean);
      }
      const std::vector<Place>& last = rests.tip.back();
      const Place mean = Mean(last);
      unlearnable_error.Add(mean, place);
      for (std::size_t k = 0; k < last.size(); ++k)
        unlearnable_motion.Add({last[k][0] - mean[0], last[k][1] - mean[1]}, course[k]);
    }
  }
  std::printf(
      "rms of the error %.2f mm, of what earlier repetitions do not predict %.2f mm;"
      " of the motion %.2f mm and %.2f mm\n",
      error.rms(), unlearnable_error.rms(), motion.rms(), unlearnable_motion.rms());
  // Half of the error, or of the motion, is what learning would have to reach.
  EXPECT_GT(unlearnable_error.rms(), 0.7 * error.rms());
  EXPECT_GT(unlearnable_motion.rms(), 0.7 * motion.rms());
}

}  // namespace
}  // namespace flexarm
