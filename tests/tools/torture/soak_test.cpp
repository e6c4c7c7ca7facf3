// The whole daemon for three days on a simulated clock: moves each hour, long rests armed and
// disarmed with a hub on the edge of a count. The sample has its first quarter of an hour, with
// every check but that of memory.
//
// What is narrow wraps: the counters of 8 bits and of 16 in each move, and any 32 bits that count
// samples, milliseconds, microseconds or nanoseconds in the first rest. What does not wrap:
// instants and numbers of samples have 64 bits (292 years). Numbers of runs and counts of failed
// exchanges have 32 bits, which a run a second fills in 136 years.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "controller/runlog/replay.h"
#include "controller/step/control_step.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/campaign.h"
#include "tools/torture/torture.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSecond = 1'000 * kMs;
constexpr std::int64_t kHour = 3'600 * kSecond;
constexpr std::int64_t kPeriodNs = 20 * kMs;

// 2^31 samples are 2^32 times 10 ms: an instant at which all 32-bit counts of these units wrap.
constexpr std::int64_t kAllWrapNs = (std::int64_t{1} << 31) * kPeriodNs;
constexpr std::int64_t kStartNs = kAllWrapNs / kSecond * kSecond - 60 * kSecond;

static_assert(std::is_same_v<decltype(StepInput::tick), std::int64_t>);
static_assert(std::is_same_v<decltype(StepInput::now_ns), std::int64_t>);
static_assert(std::is_same_v<decltype(StepInput::sampling_instant_ns), std::int64_t>);
static_assert(std::is_same_v<decltype(StepOutput::counts)::value_type, std::int64_t>);
static_assert(std::is_same_v<decltype(SafetyRecord::due_ns), std::int64_t>);

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
    scenario.wake_ups = {
        .seed = 1, .start_ns = kStartNs, .latest_ns = 400'000, .latest_slow_ns = 5 * kMs};
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
    ExpectSettledAt(deg);
  }

  // At rest within 15 mm of the target, as the benchmark calls it settled: an error of hub 1
  // moves the tip of the stretched arm by 1.7 m a rad, one of hub 2 by 0.9 m.
  void ExpectSettledAt(double deg) {
    const PlantTruth truth = session_.stack().arm().rig().truth();
    const double away_m = 1.7 * std::fabs(truth.hub_angle_rad[0] - deg * kRadPerDeg) +
                          0.9 * std::fabs(truth.hub_angle_rad[1] + deg * kRadPerDeg);
    EXPECT_LT(away_m, 0.015);
  }

  // The live loop, as the operator sees it: no log has a rest.
  struct Live {
    std::int64_t tick;
    double payload_kg, sigma_kg, mean_nis;
    std::int64_t hub1_counts;
    std::vector<double> friction_nm;
  };
  Live Look() {
    session_.Command("status");
    EXPECT_TRUE(session_.RunUntilAnswered(kSecond));
    const auto status = nlohmann::json::parse(session_.answer());
    const nlohmann::json& payload = status.at("payload");
    return {.tick = status.at("tick").get<std::int64_t>(),
            .payload_kg = payload.at("kg").get<double>(),
            .sigma_kg = payload.at("sigma_kg").get<double>(),
            .mean_nis = payload.at("mean_nis").get<double>(),
            .hub1_counts = status.at("encoders").at(0).at("counts").get<std::int64_t>(),
            .friction_nm = payload.at("friction_nm").get<std::vector<double>>()};
  }

  // At rest nothing tells of the payload: its variance grows by that of a step of the random walk a
  // sample, no faster (a flickering count is no contradiction of the model) and no slower (it is no
  // information either), until it is that of the start. No estimate moves.
  void ExpectRested(const Live& before, const Live& after) {
    const PayloadEstimatorConfig& filter = *rig_.config.estimator.payload;
    const auto samples = static_cast<double>(after.tick - before.tick);
    const double grown_kg =
        std::sqrt(before.sigma_kg * before.sigma_kg + filter.walk_kg * filter.walk_kg * samples);
    EXPECT_NEAR(after.sigma_kg, std::min(grown_kg, filter.start_sigma_kg), 1e-6);
    EXPECT_LT(after.mean_nis, 8.0);
    EXPECT_EQ(after.payload_kg, before.payload_kg);
    EXPECT_EQ(after.friction_nm, before.friction_nm);
  }

  void ExpectFlickers() {
    std::set<std::int64_t> seen;
    for (int i = 0; i < 20; ++i) {
      seen.insert(Look().hub1_counts);
      session_.RunFor(3 * kPeriodNs);
    }
    EXPECT_GE(seen.size(), 2U) << "the count stands still";
  }

  // At rest with hub 1 on the edge of a count.
  void Rest(std::int64_t ns) {
    const Live begin = Look();
    session_.stack().Flicker(&rig_.config.sensors.encoder.front());
    session_.RunFor(60 * kSecond);
    ExpectFlickers();
    const Live minute = Look();
    ExpectRested(begin, minute);
    session_.RunFor(ns - 60 * kSecond);
    const Live end = Look();
    ExpectRested(minute, end);
    EXPECT_EQ(end.sigma_kg, rig_.config.estimator.payload->start_sigma_kg) << "too short a rest";
    session_.stack().Flicker(nullptr);
    session_.RunFor(kSecond);
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
    EXPECT_NEAR(run.tick.back().output.payload_kg, 0.3, 0.3);
    ExpectWraps(run);
    session_.DropRuns();
    session_.watch().Restart();
  }

  // Each counter has wrapped.
  void ExpectWraps(const RunContents& run) {
    for (const EncoderConfig& encoder : rig_.config.sensors.encoder) {
      const auto counter = static_cast<std::size_t>(encoder.counter);
      const std::int64_t half = std::int64_t{1} << (encoder.counter_bits - 1);
      const auto wraps = [counter, half](const TickRecord& a, const TickRecord& b) {
        return std::abs(std::int64_t{b.input.frame.counter[counter]} -
                        a.input.frame.counter[counter]) >= half;
      };
      EXPECT_NE(std::adjacent_find(run.tick.begin(), run.tick.end(), wraps), run.tick.end())
          << "counter " << encoder.counter;
    }
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
    const double deg = hour % 2 == 0 ? 40.0 : 38.0;  // a counter of 8 bits wraps every 36 degrees
    MoveTo(deg);
    CheckRun();
    Rest(500 * kSecond);  // with the drives on
    Expect(SafetyState::kArmed, "a rest");
    ExpectSettledAt(deg);
    MoveTo(0.0);
    CheckRun();
    Disarm();
    Rest(hours > 0 ? kStartNs + (hour + 1) * kHour - session_.now_ns() : 500 * kSecond);
    Expect(SafetyState::kIdle, "a rest");
    session_.watch().Restart();
    // The first hours fill caches of the allocator.
    if (hour == 2) memory_mb = MemoryMb();
    if (hour > 2) {
      EXPECT_LT(MemoryMb(), memory_mb + 8.0) << "after " << hour << " hours";
    }
  }
  EXPECT_GT(session_.now_ns(), kAllWrapNs);
  EXPECT_EQ(session_.log_errors(), 0);
  EXPECT_TRUE(session_.errors().empty()) << session_.errors().front();
  EXPECT_TRUE(session_.watch().violations().empty()) << session_.watch().violations().front().what;
  EXPECT_EQ(session_.sent(), session_.answered());
  std::printf("%.1f hours, %.1f MB\n", static_cast<double>(session_.now_ns() - kStartNs) / 3.6e12,
              MemoryMb());
}

}  // namespace
}  // namespace flexarm
