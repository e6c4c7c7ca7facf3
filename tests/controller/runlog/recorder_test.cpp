// The recorder: which records belong to a run, and in which order.

#include <nlohmann/json.hpp>

#include "controller/runlog/blob.h"
#include "tests/controller/runlog/recorder_fixture.h"

namespace flexarm {
namespace {

TEST_F(RecorderTest, ARunIsFromTheResetAfterItsGrantUntilASecondAfterItsEnd) {
  RunContents run;
  Start(RunInMemory(&run));
  Arm(2 * kTestPeriodNs);
  Ticks(0, 200, 12);
  Grant(10 * kTestPeriodNs + 1);
  const SafetyRecord stopping = Change(30 * kTestPeriodNs, kRunningStatus,
                                       [](SafetyFacts* facts) { facts->experiment_done = 1; });
  Change(50 * kTestPeriodNs, stopping.after, [](SafetyFacts*) {});
  RunUntil(4 * kSecond);
  EXPECT_FALSE(recording_->is_open());
  ASSERT_FALSE(run.tick.empty());
  EXPECT_EQ(run.tick.front().input.tick, 12);  // 11 was computed before the reset
  EXPECT_EQ(run.tick.back().input.tick, 100);  // kAfterRunNs after the return to Armed
  EXPECT_EQ(run.tick.size(), 89U);
  EXPECT_EQ(run.safety.front().before.state, SafetyState::kArmed);
  EXPECT_EQ(run.info.start_ns, 10 * kTestPeriodNs) << "the millisecond in which it was granted";
  EXPECT_NE(run.info.result_json.find("\"completed\":true"), std::string::npos);
  EXPECT_TRUE(errors_.empty());
}

TEST_F(RecorderTest, DisarmingEndsARun) {
  RunContents run;
  Start(RunInMemory(&run));
  Ticks(0, 100, 12);
  Grant(10 * kTestPeriodNs + 1);
  const SafetyRecord stopping = Change(30 * kTestPeriodNs, kRunningStatus,
                                       [](SafetyFacts* facts) { facts->experiment_done = 1; });
  const SafetyRecord armed = Change(40 * kTestPeriodNs, stopping.after, [](SafetyFacts*) {});
  const SafetyRecord disarm = MakeSafety(49 * kTestPeriodNs, armed.after, RequestKind::kDisarm);
  safety_.Push(disarm);
  Change(50 * kTestPeriodNs, disarm.after, [](SafetyFacts* facts) { facts->drives_off = 1; });
  RunUntil(3 * kSecond);
  EXPECT_FALSE(recording_->is_open());
  EXPECT_EQ(run.tick.back().input.tick, 50);
  EXPECT_EQ(run.safety.size(), 5U);
}

TEST_F(RecorderTest, EachGrantIsAFile) {
  Start(InFolder(folder_));
  Ticks(1, 3, 1);
  Grant(2);
  Ticks(4, 6, 4);
  Grant(3 * kTestPeriodNs + 1);
  recorder_->Finish();
  std::vector<std::size_t> ticks;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    ticks.push_back(RunReader(entry.path()).ReadAll().tick.size());
  }
  EXPECT_EQ(ticks, (std::vector<std::size_t>{3, 3}));
}

// The next run may be granted before a second after the end of the last one is over.
TEST_F(RecorderTest, ARunThatTheNextOneFollowsAtOnceHasCompleted) {
  std::vector<RunContents> runs(2);
  std::size_t opened = 0;
  Start([&](const RunInfo& info) { return RunInMemory(&runs.at(opened++))(info); });
  Ticks(0, 60, 12);
  Grant(10 * kTestPeriodNs + 1);
  const SafetyRecord stopping = Change(30 * kTestPeriodNs, kRunningStatus,
                                       [](SafetyFacts* facts) { facts->experiment_done = 1; });
  Change(40 * kTestPeriodNs, stopping.after, [](SafetyFacts*) {});
  Grant(45 * kTestPeriodNs + 1, 2);
  RunUntil(2 * kSecond);
  const auto first = nlohmann::json::parse(runs[0].info.result_json);
  EXPECT_EQ(first.at("completed"), true);
  EXPECT_EQ(first.at("final_state"), "Armed");
}

// Who armed, and what was overridden then, belongs to each run of the arming and to no other.
TEST_F(RecorderTest, ARunBeginsWithTheEventsOfItsArming) {
  std::vector<RunContents> runs(3);
  std::size_t opened = 0;
  Start([&](const RunInfo& info) { return RunInMemory(&runs.at(opened++))(info); });
  Arm(2);
  events_.Push(
      {.time_ns = 3, .kind = "override", .name = "host", .text = "known", .value_json = {}});
  Ticks(1, 10, 1);
  Grant(5);
  SafetyStatus status = kRunningStatus;
  for (int run = 0; run < 2; ++run) {
    const std::int64_t base_ns = (10 + 100 * run) * kTestPeriodNs;
    const SafetyRecord stopping =
        Change(base_ns, status, [](SafetyFacts* facts) { facts->experiment_done = 1; });
    Change(base_ns + 1, stopping.after, [](SafetyFacts*) {});
    if (run == 0) Grant(base_ns + 50 * kTestPeriodNs);
  }
  const SafetyRecord disarm = MakeSafety(120 * kTestPeriodNs, kArmedStatus, RequestKind::kDisarm);
  safety_.Push(disarm);
  Change(121 * kTestPeriodNs, disarm.after, [](SafetyFacts* facts) { facts->drives_off = 1; });
  Arm(130 * kTestPeriodNs);
  Grant(140 * kTestPeriodNs);
  recorder_->Finish();
  const auto names = [](const RunContents& run) {
    std::vector<std::string> all;
    for (const RunEvent& event : run.event) all.push_back(event.name);
    return all;
  };
  EXPECT_EQ(names(runs[0]), (std::vector<std::string>{"arm", "host", "run"}));
  EXPECT_EQ(names(runs[1]), (std::vector<std::string>{"arm", "host", "run", "disarm"}));
  EXPECT_EQ(names(runs[2]), (std::vector<std::string>{"arm", "run"}));
}

TEST_F(RecorderTest, TheLogDoesNotDependOnWhenRecordsArrive) {
  RunContents at_once, late;
  Start(RunInMemory(&at_once));
  Grant(100);
  Ticks(1, 60, 1);
  recorder_->Finish();

  Start(RunInMemory(&late));
  Ticks(1, 1, 1);  // the tick is there before the record that opens the run
  RunUntil(RecorderTask::kPeriodNs);
  Grant(100);
  Ticks(2, 60, 1);
  RunUntil(2 * kSecond);
  recorder_->Finish();
  ASSERT_EQ(late.tick.size(), at_once.tick.size());
  EXPECT_EQ(late.tick.front().input.tick, 1);
}

// The truth of a tick is there before the tick; one that is missing leaves it unknown.
TEST_F(RecorderTest, WhatTheSimulatedArmDidIsAddedToItsTick) {
  RunContents run;
  Start(RunInMemory(&run));
  Grant(0);
  for (std::int64_t tick = 1; tick <= 4; ++tick) {
    TickRecord record = MakeTick(tick);
    record.input.reset = tick == 1 ? 1 : 0;
    record.truth = {};
    ticks_.Push(record);
  }
  for (const std::int64_t tick : {0, 1, 2, 4}) {
    truth_.Push({.tick = tick,
                 .truth = {.hub_angle_rad = {0.1 * static_cast<double>(tick), 0.0},
                           .tip_m = {},
                           .tip_deflection_m = {},
                           .known = true}});
  }
  recorder_->Finish();
  ASSERT_EQ(run.tick.size(), 4U);
  EXPECT_EQ(run.tick[1].truth.hub_angle_rad[0], 0.2);
  EXPECT_FALSE(run.tick[2].truth.known);
  EXPECT_EQ(run.tick[3].truth.hub_angle_rad[0], 0.4);
}

TEST_F(RecorderTest, ARefusalIsAnEventWithItsReason) {
  RunContents run;
  Start(RunInMemory(&run));
  Grant(0);
  safety_.Push(MakeSafety(5, kRunningStatus, RequestKind::kReset));
  recorder_->Finish();
  ASSERT_EQ(run.event.size(), 2U);
  EXPECT_EQ(run.event[1].kind, "refusal");
  EXPECT_EQ(run.event[1].name, "reset");
  EXPECT_FALSE(run.event[1].text.empty());
}

TEST_F(RecorderTest, TheExperimentOfTheGrantedRequestNamesTheFile) {
  Start(InFolder(folder_));
  events_.Push({.time_ns = 1,
                .kind = "experiment",
                .name = "sine",
                .text = "x = 1",
                .value_json = "{\"number\": 7}"});
  Grant(2, 7);
  Ticks(1, 3, 1);
  recorder_->Finish();
  ASSERT_EQ(notes_.size(), 1U);
  const auto file = std::filesystem::directory_iterator(folder_)->path();
  EXPECT_NE(file.string().find("-sine.flexarm"), std::string::npos) << file;
  EXPECT_EQ(RunReader(file).info().experiment_text, "x = 1");
}

// That of a request that was refused, or came too late, names nothing.
TEST_F(RecorderTest, TheExperimentOfAnotherRequestIsNotThatOfTheRun) {
  RunContents run;
  Start(RunInMemory(&run));
  events_.Push({.time_ns = 1,
                .kind = "experiment",
                .name = "big",
                .text = "x = 1",
                .value_json = "{\"number\": 6}"});
  Grant(2, 7);
  events_.Push({.time_ns = 5,
                .kind = "experiment",
                .name = "late",
                .text = "x = 2",
                .value_json = "{\"number\": 8}"});
  recorder_->Finish();
  EXPECT_EQ(run.info.experiment_name, "");
  EXPECT_EQ(run.info.experiment_text, "");
  ASSERT_EQ(run.event.size(), 1U);
  EXPECT_EQ(run.event[0].name, "run");
}

TEST_F(RecorderTest, EqualRunsWriteTheSameTickTable) {
  for (const char* name : {"a", "b"}) {
    Start(RunInFile(File(name)));
    due_ns_ = 0;
    Grant(0);
    Ticks(1, 50, 1);
    RunUntil(2 * kSecond);
    recorder_->Finish();
  }
  const RunContents a = RunReader(File("a")).ReadAll(), b = RunReader(File("b")).ReadAll();
  ASSERT_EQ(a.tick.size(), b.tick.size());
  for (std::size_t i = 0; i < a.tick.size(); ++i) {
    EXPECT_TRUE(SameBytes(a.tick[i].input, b.tick[i].input));
    EXPECT_TRUE(SameBytes(a.tick[i].output, b.tick[i].output));
  }
}

}  // namespace
}  // namespace flexarm
