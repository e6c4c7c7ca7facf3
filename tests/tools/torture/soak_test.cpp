// The whole daemon for three days on a simulated clock: moves each hour, long rests armed and
// disarmed. Three of the four counters have 8 bits and wrap every 36 degrees, so in each move
// of 40. The sample has 6 minutes.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "controller/runlog/replay.h"
#include "controller/step/control_step.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/campaign.h"
#include "tools/torture/torture.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSecond = 1'000 * kMs;
constexpr std::int64_t kHour = 3'600 * kSecond;

double MemoryMb() {
  long pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) / 1e6;
}

class Soak : public testing::Test {
 protected:
  Soak()
      : rig_(ShippedRig({"controller.name=gain-scheduled"})),
        session_(rig_, Scenario(), {.torque_after_ns = -1, .most = kEnvelope}) {}

  static TortureScenario Scenario() {
    TortureScenario scenario{.seed = 1, .law = "gain-scheduled"};
    scenario.payload_kg = 0.3;
    scenario.wake_ups = {.seed = 1, .latest_ns = 400'000, .latest_slow_ns = 5 * kMs};
    return scenario;
  }

  void Expect(SafetyState state, const char* when) {
    ASSERT_EQ(session_.state(), state) << when << " after " << session_.now_ns() / kSecond << " s";
  }

  void MoveTo(double deg) {
    session_.Send(nlohmann::json{{"command", "run"},
                                 {"experiment",
                                  "name = \"soak\"\nduration_s = 4.0\n[[move]]\n"
                                  "start_s = 0.0\nduration_s = 2.0\nto_deg = [" +
                                      std::to_string(deg) + ", " + std::to_string(-deg) + "]\n"}}
                      .dump());
    ASSERT_TRUE(session_.RunUntilState(SafetyState::kRunning, 2 * kSecond));
    ASSERT_TRUE(session_.RunUntilState(SafetyState::kArmed, 10 * kSecond));
    session_.RunFor(2 * kSecond);  // the recorder closes the run
    const PlantTruth truth = session_.stack().arm().rig().truth();
    // At rest within 15 mm of the target, as the benchmark calls it settled: an error of hub 1
    // moves the tip of the stretched arm by 1.7 m a rad, one of hub 2 by 0.9 m.
    const double away_m = 1.7 * std::fabs(truth.hub_angle_rad[0] - deg * kRadPerDeg) +
                          0.9 * std::fabs(truth.hub_angle_rad[1] + deg * kRadPerDeg);
    EXPECT_LT(away_m, 0.015);
  }

  void Arm() {
    session_.Command("arm");
    ASSERT_TRUE(session_.RunUntilAnswered(kSecond));
    Expect(SafetyState::kArmed, "arm");
  }

  void Disarm() {
    session_.Command("disarm");
    ASSERT_TRUE(session_.RunUntilAnswered(kSecond));
    Expect(SafetyState::kIdle, "disarm");
  }

  // The newest run replays to the bit; its last estimate is a number of the usual size.
  void CheckRun() {
    const RunContents& run = session_.runs().back();
    ControlStep step(rig_.config, rig_.design);
    Replay replay([&step](const StepInput& input) { return step.Step(input); }, false);
    for (const TickRecord& tick : run.tick) replay.Tick(tick);
    for (const SafetyRecord& record : run.safety) replay.Safety(record);
    const ReplayResult result = replay.Result();
    EXPECT_GT(result.ticks, 150);
    EXPECT_TRUE(result.bit_exact.value_or(false));
    EXPECT_TRUE(result.safety_exact.value_or(false));
    EXPECT_FALSE(result.first_gap_tick);
    const StepOutput& last = run.tick.back().output;
    EXPECT_LT(last.payload_sigma_kg, 0.5) << "the covariance grew at rest";
    EXPECT_NEAR(last.payload_kg, 0.3, 0.3);
    session_.DropRuns();
    session_.watch().Restart();
  }

  const TorturedRig rig_;
  TortureSession session_;
};

TEST_F(Soak, CampaignOfThreeDays) {
  const long hours = CampaignCases(0, 72);
  double memory_mb = 0.0;
  session_.RunFor(kSecond);
  for (long hour = 0; hour < std::max(hours, 1L) && !HasFatalFailure(); ++hour) {
    Arm();
    MoveTo(hour % 2 == 0 ? 40.0 : 30.0);
    CheckRun();
    session_.RunFor(hours > 0 ? 500 * kSecond : 60 * kSecond);  // at rest, with the drives on
    Expect(SafetyState::kArmed, "a rest");
    MoveTo(0.0);
    CheckRun();
    Disarm();
    session_.RunFor(hours > 0 ? (hour + 1) * kHour - session_.now_ns() : 300 * kSecond);
    session_.watch().Restart();
    // The first hours fill caches of the allocator.
    if (hour == 2) memory_mb = MemoryMb();
    if (hour > 2) {
      EXPECT_LT(MemoryMb(), memory_mb + 8.0) << "after " << hour << " hours";
    }
  }
  EXPECT_EQ(session_.log_errors(), 0);
  EXPECT_TRUE(session_.errors().empty()) << session_.errors().front();
  EXPECT_TRUE(session_.watch().violations().empty()) << session_.watch().violations().front().what;
  EXPECT_EQ(session_.sent(), session_.answered());
  std::printf("%.1f hours, %.1f MB\n", static_cast<double>(session_.now_ns()) / 3.6e12, MemoryMb());
}

}  // namespace
}  // namespace flexarm
