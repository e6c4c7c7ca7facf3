// The log of a trip: what it begins and ends with.

#include "tests/controller/runlog/recorder_fixture.h"

namespace flexarm {
namespace {

TEST_F(RecorderTest, ATripOutsideARunIsALogOfTheLastTenSeconds) {
  Start(InFolder(folder_));
  Arm(2);
  Ticks(1, 1500, 1);
  events_.Push({.time_ns = 15 * kSecond,
                .kind = "warning",
                .name = "delay",
                .text = "long",
                .value_json = {}});
  safety_.Push(MakeSafety(20 * kSecond, kArmedStatus, RequestKind::kNone,
                          CauseBit(TripCause::kLimitSwitch2High)));
  RunUntil(28 * kSecond);
  EXPECT_FALSE(recording_->is_open());
  const auto file = std::filesystem::directory_iterator(folder_)->path();
  EXPECT_NE(file.string().find("-trip-limit-switch-2-high.flexarm"), std::string::npos) << file;
  const RunContents run = RunReader(file).ReadAll();
  // The newest record before the trip is the tick of 19.98 s.
  EXPECT_EQ(run.tick.front().input.now_ns, 10 * kSecond - kTestPeriodNs);
  EXPECT_EQ(run.tick.back().input.now_ns, 25 * kSecond);
  EXPECT_EQ(run.tick.size(), 752U);
  EXPECT_EQ(run.safety.size(), 1U);
  ASSERT_EQ(run.event.size(), 3U);
  EXPECT_EQ(run.event[0].name, "arm") << "who armed it, though that is older";
  EXPECT_EQ(run.event[1].name, "delay");
  EXPECT_EQ(run.event[2].kind, "trip");
  EXPECT_NE(run.info.result_json.find("\"completed\":false"), std::string::npos);
}

// Otherwise the log of a trip soon after another began with that, and so did its report.
TEST_F(RecorderTest, ATripSoonAfterAResetIsTheOnlyOneOfItsLog) {
  std::vector<RunContents> runs(2);
  std::size_t opened = 0;
  Start([&](const RunInfo& info) { return RunInMemory(&runs.at(opened++))(info); });
  Ticks(1, 300, 1);
  Arm(2);
  const auto trips_at = [&](std::int64_t due_ns, TripCause cause) {
    safety_.Push(MakeSafety(due_ns, kArmedStatus, RequestKind::kNone, CauseBit(cause)));
  };
  trips_at(kSecond, TripCause::kLimitSwitch2High);
  SafetyRecord reset = MakeSafety(2 * kSecond, kIdleStatus, RequestKind::kReset);
  reset.before = {SafetyState::kTripped, TripCause::kLimitSwitch2High};
  reset.after = kIdleStatus;
  safety_.Push(reset);
  Arm(2 * kSecond + 2);
  trips_at(3 * kSecond, TripCause::kEmergencyStop);
  RunUntil(9 * kSecond);
  ASSERT_EQ(opened, 2U);
  const auto trips_of = [](const RunContents& run) {
    std::vector<std::string> names;
    for (const RunEvent& event : run.event) {
      if (event.kind == "trip") names.push_back(event.name);
    }
    return names;
  };
  EXPECT_EQ(trips_of(runs[0]), std::vector<std::string>{"limit-switch-2-high"});
  EXPECT_EQ(trips_of(runs[1]), std::vector<std::string>{"emergency-stop"});
  EXPECT_EQ(runs[1].safety.front().due_ns, 2 * kSecond) << "the reset";
  EXPECT_EQ(runs[1].tick.front().input.now_ns, 2 * kSecond);
}

TEST_F(RecorderTest, ATripIsFollowedForFiveSecondsAndNamed) {
  RunContents run;
  Start(RunInMemory(&run));
  Grant(0);
  Ticks(1, 400, 1);
  SafetyRecord trip = MakeSafety(kSecond, kRunningStatus, RequestKind::kNone,
                                 CauseBit(TripCause::kLimitSwitch2High));
  trip.evidence = {.value = 1.5, .limit = 1.25, .channel = 2, .detail = 0};
  safety_.Push(trip);
  RunUntil(9 * kSecond);
  EXPECT_FALSE(recording_->is_open());
  EXPECT_EQ(run.tick.back().input.now_ns, 6 * kSecond);
  ASSERT_EQ(run.event.size(), 2U);
  EXPECT_EQ(run.event[0].name, "run");
  EXPECT_EQ(run.event[1].kind, "trip");
  EXPECT_EQ(run.event[1].name, "limit-switch-2-high");
  EXPECT_NE(run.event[1].value_json.find("1.25"), std::string::npos);
  EXPECT_NE(run.info.result_json.find("\"trip\":\"limit-switch-2-high\""), std::string::npos);
  EXPECT_NE(run.info.result_json.find("\"completed\":false"), std::string::npos);
}

}  // namespace
}  // namespace flexarm
