// The recorder: which records belong to a run, in which order, and what happens on a disk error.

#include <sys/stat.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "controller/runlog/blob.h"
#include "controller/runlog/recorder_task.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr SafetyStatus kArmedStatus{SafetyState::kArmed, TripCause::kNone};
constexpr SafetyStatus kRunningStatus{SafetyState::kRunning, TripCause::kNone};

OpenSink InFolder(const std::filesystem::path& folder) {
  return [folder](const RunInfo& info) {
    return RunInFile(NewRunFile(folder, info.experiment_name))(info);
  };
}

class RecorderTest : public RunLogTest {
 protected:
  explicit RecorderTest(std::size_t capacity = 4096)
      : ticks_(capacity), safety_(capacity), timing_(capacity), events_(capacity) {}

  void Start(OpenSink open) {
    recording_.emplace(MakeInfo(), std::move(open), [this](bool is_error, const std::string& text) {
      (is_error ? errors_ : notes_).push_back(text);
    });
    recorder_.emplace(RecorderChannels{&ticks_, &safety_, &timing_, &events_, &truth_},
                      &*recording_);
  }
  void Arm(std::int64_t at_ns) { safety_.Push(MakeSafety(at_ns, kIdleStatus, RequestKind::kArm)); }
  // Grants a run at `at_ns`; the first tick after it carries the reset.
  void Grant(std::int64_t at_ns, std::uint32_t number = 1) {
    SafetyRecord record = MakeSafety(at_ns, kArmedStatus, RequestKind::kRun);
    record.request_number = number;
    safety_.Push(record);
  }
  // From `before`: a change without a request, by these facts.
  SafetyRecord Change(std::int64_t at_ns, SafetyStatus before,
                      const std::function<void(SafetyFacts*)>& set) {
    SafetyRecord record = MakeSafety(at_ns, before, RequestKind::kNone);
    set(&record.facts);
    const SafetyDecision next = NextSafetyState(before, record.facts);
    record.after = next.status;
    safety_.Push(record);
    return record;
  }
  void Ticks(std::int64_t first, std::int64_t last, std::int64_t reset) {
    for (std::int64_t tick = first; tick <= last; ++tick) {
      TickRecord record = MakeTick(tick);
      record.input.reset = tick == reset ? 1 : 0;
      ticks_.Push(record);
    }
  }
  void RunUntil(std::int64_t end_ns) {
    for (; due_ns_ <= end_ns; due_ns_ += RecorderTask::kPeriodNs) {
      recorder_->Run({.due_ns = due_ns_, .missed_in_a_row = 0});
    }
  }

  SpscQueue<TickRecord> ticks_;
  SpscQueue<SafetyRecord> safety_;
  SpscQueue<TimingRecord> timing_;
  EventQueue events_;
  SpscQueue<TruthRecord> truth_{4096};
  std::optional<RunRecording> recording_;
  std::optional<RecorderTask> recorder_;
  std::vector<std::string> errors_, notes_;
  std::int64_t due_ns_ = 0;
};

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

TEST_F(RecorderTest, AMissingTickIsAnEvent) {
  RunContents run;
  Start(RunInMemory(&run));
  Grant(0);
  Ticks(1, 5, 1);
  Ticks(9, 10, 1);
  recorder_->Finish();
  ASSERT_EQ(run.event.size(), 2U);
  EXPECT_EQ(run.event[1].kind, "gap");
  EXPECT_EQ(run.event[1].value_json, "{\"first_tick\":6,\"ticks\":3}");
  EXPECT_NE(run.info.result_json.find("\"missing_ticks\":3"), std::string::npos);
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

TEST_F(RecorderTest, RecordsAreCommittedWithinHalfASecond) {
  Start(RunInFile(File()));
  Grant(0);
  for (std::int64_t tick = 1; tick <= 500; ++tick) {
    const std::int64_t now_ns = tick * kTestPeriodNs;
    Ticks(tick, tick, 1);
    RunUntil(now_ns);
    if (now_ns < kSecond || tick % 10 != 0) continue;
    RunReader reader(File());  // reads what remains of a killed process
    std::int64_t last_ns = 0;
    reader.ForEachTick([&](const TickRecord& record) { last_ns = record.input.now_ns; });
    EXPECT_LE(now_ns - last_ns, kSecond / 2);
  }
  recorder_->Finish();
}

TEST_F(RecorderTest, ADiskErrorIsReportedAndCountedAndTheNextRunIsRecorded) {
  WriteText(File("blocked"), "a file where a folder should be");
  int opened = 0;
  RunContents second;
  Start([&](const RunInfo& info) -> std::unique_ptr<RunSink> {
    if (++opened == 1) return InFolder(File("blocked"))(info);
    return RunInMemory(&second)(info);
  });
  Grant(0);
  Ticks(1, 10, 1);
  Grant(20 * kTestPeriodNs);
  Ticks(21, 30, 21);
  recorder_->Finish();
  EXPECT_EQ(recording_->errors(), 1);
  ASSERT_EQ(errors_.size(), 1U);
  EXPECT_NE(errors_[0].find("Not a directory"), std::string::npos) << errors_[0];
  EXPECT_EQ(second.tick.size(), 10U);
}

class SmallQueueTest : public RecorderTest {
 protected:
  SmallQueueTest() : RecorderTest(8) {}
};

TEST_F(SmallQueueTest, DroppedRecordsAreAnEvent) {
  RunContents run;
  Start(RunInMemory(&run));
  Grant(0);
  Ticks(1, 100, 1);
  due_ns_ = RecorderTask::kPeriodNs;
  RunUntil(kSecond);
  recorder_->Finish();
  const auto is_dropped = [](const RunEvent& event) { return event.name == "dropped"; };
  ASSERT_EQ(std::count_if(run.event.begin(), run.event.end(), is_dropped), 1);
  EXPECT_EQ(run.tick.size() + ticks_.dropped(), 100U);
}

// Between two runs no log has the event: the journal has the line.
TEST_F(SmallQueueTest, RecordsDroppedWithoutARunAreInTheJournal) {
  RunContents run;
  Start(RunInMemory(&run));
  Ticks(1, 100, 1);
  RunUntil(kSecond);
  ASSERT_GT(ticks_.dropped(), 0U);
  ASSERT_EQ(errors_.size(), 1U);
  EXPECT_EQ(errors_[0], "log: " + std::to_string(ticks_.dropped()) +
                            " records were dropped: the recorder was too slow.");
  EXPECT_EQ(recording_->errors(), 0) << "no recording has ended";
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
