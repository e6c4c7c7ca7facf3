// A load picked up or dropped, at rest and during a move, and moves without a pause: under the laws
// that estimate the payload, on moves, payloads and seeds that were not used for tuning
// (docs/theory/payload.md 6.1). The numbers in the comments are for gain-scheduled unless stated
// otherwise.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "controller/runlog/metrics.h"
#include "model/rigid_joint/rigid_joint_arm.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/controller/loop/stack_run.h"
#include "tests/support/loop_time.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

constexpr double kSettled_s = 0.3;
constexpr double kSettledWithin_m = 0.015;

/// Settings of a run.
struct Scene {
  Experiment experiment{};
  double payload_kg = 0.0;  // initial payload of the arm
  std::uint64_t seed = 0;
};

/// Result of a run.
struct EventOutcome {
  TripCause trip = TripCause::kNone;
  bool completed = false;
  bool finite = true;
  bool torque_after_trip = false;
  double last_rate_rad_s = 0.0;  // of the hubs, over the last half second that was simulated
  double farthest_deg = 0.0;     // largest angle of a hub from zero
  double settling_s = 0.0;       // t15, the largest over the rests
  std::uint32_t warnings = 0;
  std::vector<TickRecord> running;  // from sample -1 of the experiment on
};

class PayloadEvents : public testing::TestWithParam<const char*> {
 protected:
  PayloadEvents()
      : config_([] {
          std::vector<std::string> overrides = kWideRig;
          overrides.push_back(std::string("controller.name=") + GetParam());
          return ShippedRig(overrides);
        }()),
        arm_(config_.arm) {}

  RandomMoves MovesOf(std::uint64_t seed, int moves = 4) const {
    return MakeRandomMoves(arm_, seed, 1.0, moves);
  }

  std::vector<EventOutcome> RunAll(const std::vector<Scene>& scenes) const {
    std::vector<EventOutcome> outcomes(scenes.size());
    ParallelFor(scenes.size(), [&](std::size_t i) { outcomes[i] = RunOne(scenes[i]); });
    return outcomes;
  }

 private:
  EventOutcome RunOne(const Scene& scene) const;

  RigConfig config_;
  RigidJointArm arm_;
};

bool Finite(const TickRecord& record) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(record.output.x_hat.begin(), record.output.x_hat.end(), finite) &&
         std::all_of(record.output.torque_nm.begin(), record.output.torque_nm.end(), finite) &&
         std::all_of(record.truth.tip_m.begin(), record.truth.tip_m.end(), finite) &&
         finite(record.output.payload_kg) && finite(record.output.mean_nis);
}

EventOutcome PayloadEvents::RunOne(const Scene& scene) const {
  constexpr double kAround_s = 15.0;  // to arm and to disarm, or to come to rest after a trip
  RigConfig config = config_;
  config.sim.seed = scene.seed;
  StackRun run(config, scene.experiment, scene.payload_kg);
  run.Run(std::llround((scene.experiment.duration_s + kAround_s) * 1e9));
  EventOutcome out;
  out.trip = run.permit().cause;
  out.completed = run.permit().state == SafetyState::kIdle && out.trip == TripCause::kNone;
  int tripped = 0;
  for (const TickRecord& record : run.tick) {
    out.finite = out.finite && Finite(record);
    for (const double angle_rad : record.truth.hub_angle_rad) {
      out.farthest_deg =
          std::max(out.farthest_deg, std::fabs(angle_rad) * 180.0 / std::numbers::pi);
    }
    if (record.input.safety_state == SafetyState::kRunning) {
      if ((record.output.payload_warnings & kPayloadModelMismatch) != 0) {
        EXPECT_EQ(record.output.payload_kg, 0.0) << "the payload is assumed lost";
      }
      out.warnings |= record.output.payload_warnings;
      out.running.push_back(record);
    }
    // The first frame after the trip still contains the torque before it.
    tripped = record.input.safety_state == SafetyState::kTripped ? tripped + 1 : 0;
    if (tripped > 2 && record.input.applied_torque_nm != std::array{0.0, 0.0}) {
      out.torque_after_trip = true;
    }
  }
  const TickRecord &last = run.tick.back(), &earlier = run.tick[run.tick.size() - 26];
  for (std::size_t i = 0; i < 2; ++i) {
    out.last_rate_rad_s =
        std::max(out.last_rate_rad_s,
                 std::fabs(last.truth.hub_angle_rad[i] - earlier.truth.hub_angle_rad[i]) / 0.5);
  }
  const RunMetrics metrics =
      ComputeMetrics(run.tick, scene.experiment, kPeriod_s, TipGeometryOf(config));
  out.settling_s = metrics.tip_settling_time_s.value_or(std::numeric_limits<double>::infinity());
  return out;
}

double MiddleOf(const Move& move) { return move.start_s + 0.5 * *move.duration_s; }

// Half of the rest of 1.5 s after the move.
double RestAfter(const Move& move) { return move.start_s + *move.duration_s + 0.75; }

void Print(const char* what, const Scene& scene, double load_kg, const EventOutcome& out) {
  std::printf("  %-22s seed %llu, %.2f kg: ", what, static_cast<unsigned long long>(scene.seed),
              load_kg);
  if (out.completed) {
    std::printf("t15 %.2f s", out.settling_s);
  } else {
    std::printf("trips %s, a hub reaches %.0f deg", ToString(out.trip), out.farthest_deg);
  }
  std::printf("%s; %.3f kg found\n",
              (out.warnings & kPayloadModelMismatch) != 0 ? ", payload-model-mismatch" : "",
              out.running.back().output.payload_kg);
}

int SettledInTime(const std::vector<EventOutcome>& outcomes) {
  return static_cast<int>(
      std::count_if(outcomes.begin(), outcomes.end(),
                    [](const EventOutcome& out) { return out.settling_s <= kSettled_s; }));
}

int Completed(const std::vector<EventOutcome>& outcomes) {
  return static_cast<int>(std::count_if(outcomes.begin(), outcomes.end(),
                                        [](const EventOutcome& out) { return out.completed; }));
}

// Completed, or tripped with a named cause, at rest and without torque; always finite, and never
// beyond the limit switches of kWideRig, where a real arm has its end stops.
void ExpectEnded(const EventOutcome& out) {
  constexpr double kSwitch_deg = 115.0;
  EXPECT_TRUE(out.finite);
  EXPECT_TRUE(out.completed || out.trip != TripCause::kNone);
  EXPECT_NE(out.trip, TripCause::kStateNotFinite);
  EXPECT_FALSE(out.torque_after_trip);
  EXPECT_LT(out.last_rate_rad_s, 0.01);
  EXPECT_LT(out.farthest_deg, kSwitch_deg);
}

// None trips, and the payload is found. The friction is compensated for 4 s after a move, so a load
// that is changed then, and not announced, may swing under the gains of the load before: 13 and 14
// of 16 runs settle in time (gain-scheduled, receding-horizon). An announced change ends the
// compensation: 15 and 16. One run fewer is allowed.
TEST_P(PayloadEvents, ALoadChangedAtRestIsEstimatedOnTheNextMove) {
  constexpr int kScenes = 16;
  std::vector<Scene> scenes;
  for (int i = 0; i < 2 * kScenes; ++i) {
    const bool picked_up = i % kScenes < 8;
    const double load_kg = 1.0 - 0.1 * (i % 8);
    Scene scene{.payload_kg = picked_up ? 0.0 : load_kg,
                .seed = 5001 + static_cast<std::uint64_t>(i % kScenes)};
    scene.experiment = MovesOf(scene.seed).experiment;
    const double at_s = RestAfter(scene.experiment.move[1]);
    scene.experiment.sim_event = {PayloadEvent(at_s, picked_up ? load_kg : 0.0)};
    if (i >= kScenes) scene.experiment.load_change = {{.at_s = at_s}};
    scenes.push_back(scene);
  }
  const std::vector<EventOutcome> outcomes = RunAll(scenes);
  std::array<int, 2> in_time{};  // not announced, announced
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const bool picked_up = i % kScenes < 8, announced = i >= kScenes;
    const double left_kg = *scenes[i].experiment.sim_event[0].payload_kg;
    const double load_kg = picked_up ? left_kg : scenes[i].payload_kg;
    Print(picked_up ? "picked up at rest" : "dropped at rest", scenes[i], load_kg, outcomes[i]);
    EXPECT_TRUE(outcomes[i].completed) << i;
    in_time[announced ? 1 : 0] += outcomes[i].settling_s <= kSettled_s ? 1 : 0;
    EXPECT_NEAR(outcomes[i].running.back().output.payload_kg, left_kg, 0.03) << i;
  }
  std::printf("  in time: %d not announced, %d announced, of %d\n", in_time[0], in_time[1],
              kScenes);
  EXPECT_GE(in_time[0], 12);
  EXPECT_GE(in_time[1], 14);
}

// All complete and settle in time. From 0.25 kg on the sensors contradict the model, 0.1 s after
// the drop, and never below; the estimator then assumes that the load is lost.
TEST_P(PayloadEvents, ALoadDroppedDuringAMoveIsDetected) {
  std::vector<Scene> scenes;
  for (int i = 0; i < 20; ++i) {
    Scene scene{.payload_kg = 0.05 * (i + 1), .seed = 6001 + static_cast<std::uint64_t>(i)};
    scene.experiment = MovesOf(scene.seed).experiment;
    const Move& move = scene.experiment.move[static_cast<std::size_t>(i % 4)];
    scene.experiment.sim_event = {PayloadEvent(MiddleOf(move), 0.0)};
    scenes.push_back(scene);
  }
  const std::vector<EventOutcome> outcomes = RunAll(scenes);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    Print("dropped in mid-move", scenes[i], scenes[i].payload_kg, outcomes[i]);
    ExpectEnded(outcomes[i]);
    const bool contradicted = (outcomes[i].warnings & kPayloadModelMismatch) != 0;
    const double load_kg = scenes[i].payload_kg;
    EXPECT_TRUE(contradicted || load_kg < 0.28) << i;
    EXPECT_FALSE(contradicted && load_kg < 0.18) << i;
  }
  EXPECT_EQ(Completed(outcomes), 20);
  EXPECT_GE(SettledInTime(outcomes), 19);
}

// At any time of a move, from a tenth to nine tenths of it: all of 100 complete, 95 in time, the
// latest after 0.38 s (receding-horizon: 97, 0.52 s).
TEST_P(PayloadEvents, ALoadDroppedAtAnyTimeOfAMoveCausesNoTrip) {
  constexpr int kRuns = 100;
  std::vector<Scene> scenes;
  for (int i = 0; i < kRuns; ++i) {
    const double share = 0.1 + 0.8 * ((7 * i) % kRuns + 0.5) / kRuns;
    Scene scene{.payload_kg = 0.3 + 0.7 * (i + 0.5) / kRuns,
                .seed = 9001 + static_cast<std::uint64_t>(i)};
    scene.experiment = MovesOf(scene.seed).experiment;
    const Move& move = scene.experiment.move[static_cast<std::size_t>(i % 4)];
    scene.experiment.sim_event = {PayloadEvent(move.start_s + share * *move.duration_s, 0.0)};
    scenes.push_back(scene);
  }
  const std::vector<EventOutcome> outcomes = RunAll(scenes);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!outcomes[i].completed || outcomes[i].settling_s > kSettled_s) {
      Print("dropped in mid-move", scenes[i], scenes[i].payload_kg, outcomes[i]);
    }
    ExpectEnded(outcomes[i]);
  }
  EXPECT_EQ(Completed(outcomes), kRuns);
  EXPECT_GE(SettledInTime(outcomes), 90);
}

// All complete and settle after 1.12 s at most: the remaining half of the move is too short for
// estimating the load and moving it to rest. Nothing contradicts the model.
TEST_P(PayloadEvents, ALoadPickedUpDuringAMoveCausesNoTrip) {
  std::vector<Scene> scenes;
  for (int i = 0; i < 8; ++i) {
    Scene scene{.seed = 7001 + static_cast<std::uint64_t>(i)};
    scene.experiment = MovesOf(scene.seed).experiment;
    const Move& move = scene.experiment.move[static_cast<std::size_t>(i % 4)];
    scene.experiment.sim_event = {PayloadEvent(MiddleOf(move), 1.0 - 0.1 * i)};
    scenes.push_back(scene);
  }
  const std::vector<EventOutcome> outcomes = RunAll(scenes);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    Print("picked up in mid-move", scenes[i], *scenes[i].experiment.sim_event[0].payload_kg,
          outcomes[i]);
    ExpectEnded(outcomes[i]);
  }
  EXPECT_GE(Completed(outcomes), 7);
}

TEST_P(PayloadEvents, TheShippedExperimentRunsToItsEnd) {
  const Scene scene{
      .experiment = ShippedExperiment("payload-dropped"), .payload_kg = 0.0, .seed = 1};
  const EventOutcome out = RunAll({scene}).front();
  Print("payload-dropped", scene, 0.3, out);
  EXPECT_TRUE(out.completed);
  EXPECT_LE(out.settling_s, kSettled_s);
  EXPECT_NEAR(out.running.back().output.payload_kg, 0.0, 0.03);
}

// Each move starts when the one before it ends; a rest follows the last one only.
Experiment WithoutRests(Experiment experiment) {
  double now_s = 0.0;
  for (Move& move : experiment.move) {
    move.start_s = now_s;
    now_s = kPeriod_s * std::round((now_s + *move.duration_s) / kPeriod_s);
  }
  experiment.duration_s = now_s + 1.5;
  return experiment;
}

std::array<double, 2> StraightTip_m(const ArmParameters& arm, const std::array<double, 2>& deg) {
  const double rad = std::numbers::pi / 180.0, th1 = deg[0] * rad, gamma = th1 + deg[1] * rad;
  const double L1 = arm.link[0].length_m(), L2 = arm.link[1].length_m();
  return {L1 * std::cos(th1) + L2 * std::cos(gamma), L1 * std::sin(th1) + L2 * std::sin(gamma)};
}

// Estimates of a run over some of its moves.
struct Belief {
  double payload_kg = 0.0;
  std::array<double, 2> friction_nm{};
};

Belief MeanBelief(const std::vector<TickRecord>& ends, std::size_t first, std::size_t count) {
  Belief mean;
  const double share = 1.0 / static_cast<double>(count);
  for (std::size_t i = first; i < first + count; ++i) {
    mean.payload_kg += share * ends[i].output.payload_kg;
    for (std::size_t j = 0; j < 2; ++j) {
      mean.friction_nm[j] += share * ends[i].output.friction_nm[j];
    }
  }
  return mean;
}

// The next move begins at once, so t15 is 0 where the tip is within 15 mm of where the arm would
// rest at the instant at which a move ends, and counts as usual after the last. Measured: 3.7 mm at
// most. The payload is known to 0.03 kg after every move but the first; from the first ten moves
// after that to the last ten the means shift by 0.012 kg, 0.01 and 0.005 N m, as much as they
// scatter, so twice that is allowed. 70 to 79 s.
TEST_P(PayloadEvents, ThirtyMovesWithoutAPauseCauseNoDrift) {
  constexpr std::size_t kMoves = 30, kSome = 10;
  std::vector<Scene> scenes;
  for (int i = 0; i < 3; ++i) {
    Scene scene{.payload_kg = 0.25 * (i + 1), .seed = 8001 + static_cast<std::uint64_t>(i)};
    scene.experiment = WithoutRests(MovesOf(scene.seed, kMoves).experiment);
    for (Move& move : scene.experiment.move) move.same_load = true;
    scenes.push_back(scene);
  }
  const std::vector<EventOutcome> outcomes = RunAll(scenes);
  const ArmParameters arm = ShippedRig().arm;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const EventOutcome& out = outcomes[i];
    Print("without a pause", scenes[i], scenes[i].payload_kg, out);
    ASSERT_TRUE(out.completed) << i;
    EXPECT_LE(out.settling_s, kSettled_s);
    std::vector<TickRecord> ends;
    double farthest_m = 0.0, payload_error_kg = 0.0;
    for (const Move& move : scenes[i].experiment.move) {
      const double end_s = move.start_s + *move.duration_s;
      ends.push_back(out.running[static_cast<std::size_t>(std::lround(end_s / kPeriod_s)) + 1]);
      const TickRecord& end = ends.back();
      const std::array<double, 2> place = StraightTip_m(arm, move.to_deg);
      farthest_m = std::max(
          farthest_m, std::hypot(end.truth.tip_m[0] - place[0], end.truth.tip_m[1] - place[1]));
      if (ends.size() == 1) continue;
      payload_error_kg =
          std::max(payload_error_kg, std::fabs(end.output.payload_kg - scenes[i].payload_kg));
    }
    const Belief early = MeanBelief(ends, 1, kSome), late = MeanBelief(ends, kMoves - kSome, kSome);
    std::printf(
        "    %.1f s, tip within %.1f mm at the ends, payload within %.3f kg; shifts %+.3f kg, "
        "%+.3f %+.4f N m\n",
        scenes[i].experiment.duration_s, 1e3 * farthest_m, payload_error_kg,
        late.payload_kg - early.payload_kg, late.friction_nm[0] - early.friction_nm[0],
        late.friction_nm[1] - early.friction_nm[1]);
    EXPECT_LE(farthest_m, kSettledWithin_m);
    EXPECT_LE(payload_error_kg, 0.05);
    EXPECT_NEAR(late.payload_kg, early.payload_kg, 0.025);
    EXPECT_NEAR(late.friction_nm[0], early.friction_nm[0], 0.02);
    EXPECT_NEAR(late.friction_nm[1], early.friction_nm[1], 0.01);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, PayloadEvents, testing::Values("gain-scheduled", "receding-horizon"),
                         [](const auto& shown) {
                           std::string name = shown.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace flexarm
