// Records that are missing, dropped or cannot be written.

#include <sys/stat.h>

#include "tests/controller/runlog/recorder_fixture.h"

namespace flexarm {
namespace {

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

}  // namespace
}  // namespace flexarm
