#include "tools/torture/torture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "tests/controller/law/shipped_rig.h"
#include "tests/support/campaign.h"
#include "tools/support/scratch_folder.h"
#include "tools/torture/campaign.h"
#include "tools/torture/fault_matrix.h"
#include "tools/torture/unsuited_law.h"

namespace flexarm {
namespace {

const std::vector<std::string> kTorturedLaws = {"sobel", "sobel-thesis", "gain-scheduled", "lqg",
                                                "receding-horizon"};

// The designs take a second: once.
const TorturedRigs& Rigs() {
  static const TorturedRigs rigs(
      [](const std::string& law) { return ShippedRig({"controller.name=" + law}); }, kTorturedLaws);
  return rigs;
}

const TortureSpace& Space() {
  static const TortureSpace space = SpaceOf(ShippedRig(), kTorturedLaws);
  return space;
}

TortureScenario Drawn(std::uint64_t seed) {
  static const RigConfig config = ShippedRig();
  return ScenarioOf(seed, Space(), config);
}

TEST(Torture, CampaignBreaksNoRule) {
  std::vector<std::uint64_t> seeds(static_cast<std::size_t>(CampaignCases(1'000, 20'000)));
  std::iota(seeds.begin(), seeds.end(), 1);
  const TortureSummary summary =
      RunTorture(Rigs(), ScenariosOf(seeds, Space(), ShippedRig()), CampaignJobs());
  for (const TortureFailure& failure : summary.failures) {
    ADD_FAILURE() << "seed " << failure.seed << ": " << failure.violation.rule << ": "
                  << failure.violation.what << "\n"
                  << failure.text;
  }
  // The campaign has reached what it is about: shares of what was drawn.
  EXPECT_GT(summary.clean, seeds.size() / 20);
  EXPECT_GT(summary.tripped, seeds.size() / 4);
  EXPECT_GT(summary.observable, seeds.size() / 20);
  EXPECT_GT(summary.causes.size(), 15U);
  EXPECT_GT(summary.replayed_steps, 50 * static_cast<std::int64_t>(seeds.size()));
}

TEST(Torture, EveryLawSuitsTheShippedArm) {
  for (const std::string& law : kTorturedLaws) {
    EXPECT_EQ(WhyUnsuited(Rigs(), Space(), ShippedRig(), law), "") << law;
  }
}

// Less than the model is off by in a move, or at rest.
TEST(Torture, ALawThatTripsWithoutAFaultDoesNotSuitTheArm) {
  const auto why = [](const std::string& limit_rad) {
    const std::string limit = "estimator.innovation_limit_rad=" + limit_rad;
    const TorturedRigs rigs(
        [&limit](const std::string& law) { return ShippedRig({"controller.name=" + law, limit}); },
        {"sobel"});
    return WhyUnsuited(rigs, Space(), ShippedRig({limit}), "sobel");
  };
  const std::string where = " without a fault, with 0.05 kg on the plant \"nominal\"";
  EXPECT_EQ(why("0.004"), "estimator-residual" + where);
  EXPECT_EQ(why("1e-12"), "it does not run" + where);
}

TEST(Torture, ASeedGivesTheSameSessionAgain) {
  for (const std::uint64_t seed : {4U, 19U, 25U}) {
    SCOPED_TRACE(seed);
    const TortureOutcome a = RunScenario(Rigs(), Drawn(seed)), b = RunScenario(Rigs(), Drawn(seed));
    EXPECT_EQ(a.cause, b.cause);
    EXPECT_EQ(a.latched_ns, b.latched_ns);
    EXPECT_EQ(a.tip_m, b.tip_m) << "to the bit";
    EXPECT_EQ(a.simulated_ns, b.simulated_ns);
  }
}

// `zero` stores a calibration, and a daemon loads the one that it finds: a session does not write
// the user's, and the next does not begin with that of the last.
TEST(Torture, ASessionLeavesNoCalibrationBehind) {
  TortureScenario scenario = Drawn(1);
  scenario.situation = Situation::kIdle;
  scenario.faults.clear();
  scenario.commands = {{.at_ns = 0, .text = R"({"command":"zero"})"}};
  const ScratchFolder folder(std::filesystem::temp_directory_path());
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const TortureOutcome outcome = RunScenario(Rigs(), scenario);
  std::filesystem::current_path(before);
  EXPECT_TRUE(outcome.violations.empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// A run with something of everything.
TortureScenario Crowded() {
  for (std::uint64_t seed = 1;; ++seed) {
    const TortureScenario drawn = Drawn(seed);
    if (drawn.situation == Situation::kRunning && drawn.faults.size() == 3 &&
        !drawn.commands.empty() && !drawn.plant.empty()) {
      return drawn;
    }
  }
}

// A rule that the arm breaks by moving at all: what is left is the move.
TEST(Torture, AFailureIsMinimisedToWhatBreaksItsRule) {
  const TortureScenario scenario = Crowded();
  Peaks none = kEnvelope;
  none.angle_share = 0.01;
  const TortureScenario small = Minimised(Rigs(), scenario, "envelope", none);
  EXPECT_TRUE(small.faults.empty());
  EXPECT_LE(small.after_ns, scenario.after_ns);
  EXPECT_TRUE(small.commands.empty());
  EXPECT_TRUE(small.plant.empty());
  EXPECT_EQ(small.wake_ups.latest_ns, 0);
  EXPECT_EQ(small.move_to_deg, scenario.move_to_deg);
  EXPECT_FALSE(RunScenario(Rigs(), small, none).violations.empty());
  EXPECT_TRUE(RunScenario(Rigs(), small).violations.empty());
}

// A run in mid-move, without lateness, of the nominal arm.
TortureScenario InMidMove(const Fault& fault) {
  TortureScenario scenario = Drawn(1);
  scenario.faults = {fault};
  scenario.situation = Situation::kRunning;
  scenario.plant.clear();
  scenario.commands.clear();
  scenario.wake_ups = {};
  return scenario;
}

// All gauges of link 1 lost: the cause of docs/trips.md, in the second sample without them, which
// is due 10 ms and reports 15 ms after its instant.
TEST(Torture, ALostLinkIsNamedInTheSecondSample) {
  const TortureOutcome outcome = RunScenario(Rigs(), InMidMove({.place = FaultPlace::kGauges,
                                                                .index = 0,
                                                                .kind = FaultKind::kOff,
                                                                .from_ns = 0,
                                                                .to_ns = INT64_MAX,
                                                                .seed = 1}));
  EXPECT_TRUE(outcome.violations.empty());
  EXPECT_EQ(outcome.cause, TripCause::kNoStrainReading1);
  EXPECT_GT(outcome.latched_ns, 35 * kMs);
  EXPECT_LE(outcome.latched_ns, 56 * kMs);
}

// The faults are watched for 0.7 s. One that has been seen for three samples just before has its
// three ticks all the same.
TEST(Torture, AFaultThatIsSeenAtTheEndIsWatchedUntilItMustBeNamed) {
  int named_later = 0;
  for (std::int64_t after_ms = 0; after_ms < 20; ++after_ms) {  // of a period, all
    TortureScenario scenario = InMidMove({.place = FaultPlace::kGauge,
                                          .index = 4,
                                          .kind = FaultKind::kGarbage,
                                          .from_ns = 620 * kMs,
                                          .to_ns = INT64_MAX,
                                          .seed = 1});
    scenario.after_ns += after_ms * kMs;
    const TortureOutcome outcome = RunScenario(Rigs(), scenario);
    EXPECT_TRUE(outcome.violations.empty()) << after_ms;
    if (outcome.latched_ns > 700 * kMs && outcome.latched_ns < INT64_MAX) ++named_later;
  }
  EXPECT_GT(named_later, 0);
}

// A torque that is not that of the command breaks a limit, and the arm is damped: in some sessions
// a reading becomes implausible as well, and then nothing is damped.
TEST(Torture, MostFaultsInFaultStoppingBeginInThatState) {
  int damped = 0, sessions = 0;
  for (std::uint64_t seed = 1; sessions < 10; ++seed) {
    const TortureScenario scenario = Drawn(seed);
    if (scenario.situation != Situation::kFaultStopping) continue;
    const TortureOutcome outcome = RunScenario(Rigs(), scenario);
    EXPECT_TRUE(outcome.reached && outcome.violations.empty()) << seed;
    if (outcome.began_in == SafetyState::kFaultStopping) ++damped;
    ++sessions;
  }
  EXPECT_GE(damped, sessions / 2);
}

// The link bends farther than in the move alone, long before the fault ends.
TEST(Torture, TheShortestFaultThatBreaksTheRuleIsFound) {
  const TortureScenario scenario = InMidMove({.place = FaultPlace::kTorque,
                                              .index = 1,
                                              .kind = FaultKind::kGarbage,
                                              .from_ns = 0,
                                              .to_ns = 512 * kMs,
                                              .seed = 1});
  TortureScenario well = scenario;
  well.faults.clear();
  const double moves = RunScenario(Rigs(), well).peaks.strain_share;
  const double fault = RunScenario(Rigs(), scenario).peaks.strain_share;
  ASSERT_GT(fault, 1.2 * moves);
  Peaks tight = kEnvelope;
  tight.strain_share = 0.5 * (moves + fault);
  const TortureScenario small = Minimised(Rigs(), scenario, "envelope", tight);
  ASSERT_EQ(small.faults.size(), 1U);
  EXPECT_LT(small.faults[0].to_ns, 512 * kMs);
  EXPECT_LE(small.after_ns, scenario.after_ns);
}

TEST(Torture, EveryPlaceKindAndSituationIsDrawn) {
  std::set<FaultPlace> places;
  std::set<FaultKind> kinds;
  std::set<Situation> situations;
  std::size_t none = 0;
  for (std::uint64_t seed = 1; seed <= 2'000; ++seed) {
    const TortureScenario scenario = Drawn(seed);
    situations.insert(scenario.situation);
    if (scenario.faults.empty()) ++none;
    for (const Fault& fault : scenario.faults) {
      EXPECT_TRUE(Exists(fault.place, fault.kind));
      EXPECT_LT(fault.index, CountOf(fault.place, Space().gauges));
      places.insert(fault.place);
      kinds.insert(fault.kind);
    }
  }
  EXPECT_EQ(places.size(), static_cast<std::size_t>(kFaultPlaces));
  EXPECT_EQ(kinds.size(), static_cast<std::size_t>(kFaultKinds));
  EXPECT_EQ(situations.size(), static_cast<std::size_t>(kSituations));
  EXPECT_NEAR(static_cast<double>(none), 200.0, 60.0);  // a tenth, 4.5 standard deviations
}

}  // namespace
}  // namespace flexarm
