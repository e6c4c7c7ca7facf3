// A disk that fails: the run goes on, the trouble is told, and nothing that was written is lost.

#include <cerrno>
#include <cstring>
#include <utility>

#include "controller/runlog/blob.h"
#include "controller/runlog/run_recovery.h"
#include "tests/controller/runlog/faulty_calls.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

int disk_error = 0;         // of each write; 0: the disk is sound
bool half_written = false;  // the next write takes half
int writes = 0;

CallFault DiskFault(std::string_view call, std::size_t) {
  if (call != "pwrite" && call != "write") return {};
  ++writes;
  return {.error = disk_error, .halves_write = std::exchange(half_written, false)};
}

class RunTroubleTest : public RunLogTest {
 protected:
  void SetUp() override {
    RunLogTest::SetUp();
    SetDisk(0);
    writes = 0;
    before_file_call = DiskFault;
  }
  void TearDown() override {
    before_file_call = nullptr;
    RunLogTest::TearDown();
  }
  static void SetDisk(int error) { disk_error = error; }

  static void WriteTicks(RunWriter* writer, int first, int last) {
    for (int tick = first; tick <= last; ++tick) writer->Tick(MakeTick(tick));
    writer->Commit();
  }
  void ExpectAllTicks(const std::filesystem::path& file, std::size_t ticks) {
    RunReader reader(file);
    const RunContents run = reader.ReadAll();
    ASSERT_EQ(run.tick.size(), ticks);
    for (std::size_t n = 0; n < ticks; ++n) {
      ASSERT_TRUE(SameBytes(run.tick[n].input, MakeTick(static_cast<int>(n) + 1).input)) << n;
    }
    EXPECT_TRUE(run.event.empty());
  }
};

TEST_F(RunTroubleTest, ACommitIsOneWrite) {
  RunWriter writer(File(), MakeInfo());
  EXPECT_EQ(writes, 1);
  writes = 0;
  WriteTicks(&writer, 1, 25);
  EXPECT_EQ(writes, 1);
  writer.Commit();
  EXPECT_EQ(writes, 1) << "nothing to write";
}

TEST_F(RunTroubleTest, WhatADiskDidNotTakeIsWrittenOnceItDoes) {
  for (const int error : {ENOSPC, EIO, EROFS, EDQUOT}) {
    const std::filesystem::path file = File(std::to_string(error) + ".flexarm");
    RunWriter writer(file, MakeInfo());
    WriteTicks(&writer, 1, 10);
    EXPECT_EQ(writer.Trouble(), "");
    SetDisk(error);
    half_written = true;
    WriteTicks(&writer, 11, 20);
    WriteTicks(&writer, 21, 30);
    const std::string trouble = writer.Trouble();
    EXPECT_EQ(trouble.find(file.string() + ": cannot write the run log: " + std::strerror(error)),
              0U)
        << trouble;
    EXPECT_NE(trouble.find(" bytes wait in memory"), std::string::npos) << trouble;
    EXPECT_GE(RunReader(file).ReadAll().tick.size(), 10U) << "what was written is there";
    SetDisk(0);
    WriteTicks(&writer, 31, 40);
    EXPECT_EQ(writer.Trouble(), "");
    ExpectAllTicks(file, 40);
    writer.Close("{}");
    ExpectAllTicks(file, 40);
  }
}

TEST_F(RunTroubleTest, WhatEvenMemoryCannotHoldIsCountedAndTold) {
  RunWriter writer(File(), MakeInfo());
  WriteTicks(&writer, 1, 10);
  SetDisk(ENOSPC);
  writer.Commit();
  int last = 10;
  for (int more = 0; more < 2; last += 1000) {
    for (int n = 1; n <= 1000; ++n) writer.Tick(MakeTick(1000 + last + n));
    writer.Commit();
    if (writer.Trouble().find(" records are lost") != std::string::npos) ++more;
  }
  SetDisk(0);
  writer.Commit();
  writer.Close("{}");
  const RunContents run = RunReader(File()).ReadAll();
  EXPECT_GT(run.tick.size(), 30'000U);
  EXPECT_LT(run.tick.size(), static_cast<std::size_t>(last));
  ASSERT_EQ(run.event.size(), 1U);
  EXPECT_EQ(run.event[0].kind, "gap");
  EXPECT_EQ(
      run.event[0].value_json,
      "{\"records\":" + std::to_string(static_cast<std::size_t>(last) - run.tick.size()) + "}");
}

TEST_F(RunTroubleTest, AFileThatWasRemovedIsThereAgainWithAllOfIt) {
  RunWriter writer(File(), MakeInfo());
  WriteTicks(&writer, 1, 10);
  std::filesystem::remove(File());
  WriteTicks(&writer, 11, 20);
  EXPECT_EQ(writer.Trouble(), "");
  ExpectAllTicks(File(), 20);
  EXPECT_EQ(RunReader(File()).state(), RunState::kWritten);
  writer.Close("{}");
  ExpectAllTicks(File(), 20);
}

TEST_F(RunTroubleTest, AFolderThatWasRemovedIsThereAgainToo) {
  const std::filesystem::path file = folder_ / "runs" / "run.flexarm";
  RunWriter writer(file, MakeInfo());
  WriteTicks(&writer, 1, 10);
  std::filesystem::remove_all(folder_ / "runs");
  WriteTicks(&writer, 11, 20);
  writer.Close("{}");
  ExpectAllTicks(file, 20);
}

TEST_F(RunTroubleTest, AFileThatWasRenamedLeavesAWholeRunUnderItsName) {
  RunWriter writer(File(), MakeInfo());
  WriteTicks(&writer, 1, 10);
  std::filesystem::rename(File(), File("moved.flexarm"));
  WriteTicks(&writer, 11, 20);
  writer.Close("{}");
  ExpectAllTicks(File(), 20);
  ExpectAllTicks(File("moved.flexarm"), 10);
}

TEST_F(RunTroubleTest, AFileInItsPlaceIsLeftAlone) {
  RunWriter writer(File(), MakeInfo());
  WriteTicks(&writer, 1, 10);
  std::filesystem::remove(File());
  WriteText(File(), "not ours");
  WriteTicks(&writer, 11, 20);
  EXPECT_EQ(writer.Name(), File("run-2.flexarm").string());
  writer.Close("{}");
  EXPECT_EQ(Bytes(File()), "not ours");
  ExpectAllTicks(File("run-2.flexarm"), 20);
}

// Removed, and no disk to make it again: the open file and memory have everything.
TEST_F(RunTroubleTest, AFileThatWasRemovedFromAFullDiskWaitsUntilThereIsRoom) {
  RunWriter writer(File(), MakeInfo());
  WriteTicks(&writer, 1, 10);
  std::filesystem::remove(File());
  SetDisk(ENOSPC);
  WriteTicks(&writer, 11, 20);
  EXPECT_NE(writer.Trouble().find("was removed, and cannot be made again: No space left"),
            std::string::npos)
      << writer.Trouble();
  SetDisk(0);
  WriteTicks(&writer, 21, 30);
  EXPECT_EQ(writer.Trouble(), "");
  writer.Close("{}");
  ExpectAllTicks(File(), 30);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(RunTroubleTest, ARunThatCannotBeClosedIsClosedWhenTheDiskAllowsIt) {
  RunWriter writer(File(), MakeInfo());
  WriteTicks(&writer, 1, 10);
  SetDisk(ENOSPC);
  WriteTicks(&writer, 11, 20);
  EndedRun ended = writer.End("{\"completed\":true}");
  EXPECT_NE(ended.Finish().find("No space left"), std::string::npos);
  EXPECT_EQ(RecoverRun(File()).result, Recovery::Result::kWritten) << "it is still ours";
  SetDisk(0);
  EXPECT_EQ(ended.Finish(), "");
  ExpectAllTicks(File(), 20);
  EXPECT_EQ(RunReader(File()).info().result_json, "{\"completed\":true}");
}

// The record file is complete, and no room is left for the database.
TEST_F(RunTroubleTest, ARecordFileThatCannotBeConvertedStaysAndIsClosedLater) {
  static bool synced;  // the record file: SQLite writes from then on
  synced = false;
  {
    RunWriter writer(File(), MakeInfo());
    WriteTicks(&writer, 1, 100);
    before_file_call = [](std::string_view call, std::size_t) -> CallFault {
      if (call == "fdatasync") synced = true;
      return {.error = synced && (call == "pwrite" || call == "write") ? ENOSPC : 0,
              .halves_write = false};
    };
    const std::string error = MessageOf<RunLogError>([&] { writer.Close("{\"completed\":true}"); });
    EXPECT_NE(error.find(File().string() + ": cannot be turned into SQLite: "), std::string::npos)
        << error;
  }
  before_file_call = nullptr;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
  EXPECT_EQ(RunReader(File()).state(), RunState::kLeft);
  const Recovery recovery = RecoverRun(File());
  EXPECT_EQ(recovery.text, File().string() + ": closed");
  ExpectAllTicks(File(), 100);
  EXPECT_EQ(RunReader(File()).info().result_json, "{\"completed\":true}");
}

TEST_F(RunTroubleTest, ANewRunOnAFullDiskIsRefusedAndLeavesNoFile) {
  SetDisk(ENOSPC);
  const std::string error = MessageOf<RunLogError>([&] { RunWriter(File(), MakeInfo()); });
  EXPECT_NE(error.find("No space left on device"), std::string::npos) << error;
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(RunTroubleTest, SpaceThatCannotBeReservedIsRefusedAndLeavesNoFile) {
  before_file_call = [](std::string_view call, std::size_t) -> CallFault {
    return {.error = call == "fallocate" ? ENOSPC : 0, .halves_write = false};
  };
  const std::string error =
      MessageOf<RunLogError>([&] { ReservedRunFile::In(folder_, 1'000'000); });
  EXPECT_NE(error.find("No space left on device"), std::string::npos) << error;
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace flexarm
