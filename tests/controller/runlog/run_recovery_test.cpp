// What killed programs left becomes closed runs, and what is not theirs stays.

#include "controller/runlog/run_recovery.h"

#include <signal.h>
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "controller/runlog/append_file.h"
#include "controller/runlog/blob.h"
#include "controller/runlog/run_file_lock.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

class RunRecoveryTest : public RunLogTest {
 protected:
  // A process that writes ticks, commits after every 25th, and is killed.
  void WriteAndDie(const std::filesystem::path& file, int ticks) {
    const pid_t child = ::fork();
    if (child == 0) {
      RunWriter writer(file, MakeInfo());
      writer.Safety(MakeSafety(1, kIdleStatus, RequestKind::kArm));
      for (int tick = 1; tick <= ticks; ++tick) {
        writer.Tick(MakeTick(tick));
        if (tick % 25 == 0) writer.Commit();
      }
      ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
  }
  void Recover() {
    RecoverRuns(folder_, [this](bool is_error, const std::string& text) {
      (is_error ? errors_ : notes_).push_back(text);
    });
  }
  std::vector<std::string> errors_, notes_;
};

TEST_F(RunRecoveryTest, ARunThatWasKilledBecomesAClosedRunThatSaysSo) {
  WriteAndDie(File(), 60);
  ASSERT_EQ(RunReader(File()).state(), RunState::kLeft);
  Recover();
  EXPECT_TRUE(errors_.empty());
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_EQ(notes_[0], "run " + File().string() + ": recovered");
  RunReader reader(File());
  EXPECT_TRUE(reader.closed());
  EXPECT_TRUE(reader.DigestHolds());
  const RunContents run = reader.ReadAll();
  ASSERT_EQ(run.tick.size(), 50U);
  EXPECT_TRUE(SameBytes(run.tick.back().output, MakeTick(50).output));
  const nlohmann::json result = nlohmann::json::parse(run.info.result_json);
  EXPECT_EQ(result["recovered"], true);
  EXPECT_EQ(result["completed"], false);
  EXPECT_EQ(result["ticks"], 50);
  EXPECT_EQ(result["missing_ticks"], 0);
  EXPECT_EQ(result["final_state"], "Armed");
  EXPECT_EQ(result["trip"], nullptr);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
  notes_.clear();
  Recover();
  EXPECT_TRUE(notes_.empty()) << "it is recovered once";
}

// Found by fuzzing: a record file with right checksums can have any times and ticks.
TEST_F(RunRecoveryTest, TimesAndTicksOfAnySizeAreRecovered) {
  std::string left;
  {
    RunWriter writer(File("whole"), MakeInfo());
    for (const std::int64_t end : {INT64_MIN, INT64_MAX}) {
      TickRecord tick = MakeTick(1);
      tick.input.tick = end;
      tick.input.now_ns = end;
      writer.Tick(tick);
      writer.Commit();
    }
    left = Bytes(File("whole"));
  }
  WriteText(File(), left);
  Recover();
  EXPECT_TRUE(errors_.empty());
  const RunContents run = RunReader(File()).ReadAll();
  ASSERT_EQ(run.tick.size(), 2U);
  EXPECT_EQ(run.tick[0].input.now_ns, INT64_MIN);
  EXPECT_EQ(run.tick[1].input.now_ns, INT64_MAX);
  EXPECT_EQ(nlohmann::json::parse(run.info.result_json)["ticks"], 2);
}

TEST_F(RunRecoveryTest, ARunThatIsBeingWrittenIsLeftToItsWriter) {
  RunWriter writer(File(), MakeInfo());
  writer.Tick(MakeTick(1));
  writer.Commit();
  const std::string before = Bytes(File());
  Recover();
  EXPECT_TRUE(notes_.empty());
  EXPECT_EQ(RecoverRun(File()).result, Recovery::Result::kWritten);
  EXPECT_EQ(Bytes(File()), before);
  writer.Tick(MakeTick(2));
  writer.Close("{}");
  EXPECT_EQ(RunReader(File()).ReadAll().tick.size(), 2U);
}

TEST_F(RunRecoveryTest, ClosedRunsAndOtherFilesStayAsTheyAre) {
  {
    RunWriter writer(File("closed.flexarm"), MakeInfo());
    writer.Close("{}");
  }
  WriteText(File("notes.flexarm"), "not ours");
  WriteText(File("picture.png"), "png");
  const std::string closed = Bytes(File("closed.flexarm"));
  Recover();
  EXPECT_TRUE(notes_.empty() && errors_.empty());
  EXPECT_EQ(Bytes(File("closed.flexarm")), closed);
  EXPECT_EQ(Bytes(File("notes.flexarm")), "not ours");
  EXPECT_TRUE(std::filesystem::exists(File("picture.png")));
}

TEST_F(RunRecoveryTest, LeftOversOfAReservationAndOfAConversionAreRemoved) {
  WriteAndDie(File(), 50);
  WriteText(PartOf(File()), "half of a database");
  WriteText(File(".next-abcdef.reserved"), "");
  Recover();
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
  EXPECT_EQ(RunReader(File()).ReadAll().tick.size(), 50U);
}

TEST_F(RunRecoveryTest, AReservedFileOfALiveProgramStays) {
  const ReservedRunFile reserved = ReservedRunFile::In(folder_, 10'000);
  Recover();
  EXPECT_TRUE(std::filesystem::exists(reserved.path()));
}

TEST_F(RunRecoveryTest, AFileThatCannotBeRecoveredIsAnErrorLineAndStopsNoOther) {
  WriteAndDie(File("a.flexarm"), 50);
  WriteAndDie(File("b.flexarm"), 50);
  std::string bytes = Bytes(File("a.flexarm"));
  bytes[10] ^= 1;
  WriteText(File("a.flexarm"), bytes);
  Recover();
  ASSERT_EQ(errors_.size(), 1U);
  EXPECT_NE(errors_[0].find("a.flexarm: is damaged in its header"), std::string::npos)
      << errors_[0];
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("b.flexarm"), std::string::npos);
}

TEST_F(RunRecoveryTest, AFolderThatIsNotThereHasNothingToRecover) {
  RecoverRuns(File("nowhere"), [this](bool, const std::string& text) { errors_.push_back(text); });
  EXPECT_TRUE(errors_.empty());
}

TEST_F(RunRecoveryTest, AReservedFileIsRemovedUnlessARunTookIt) {
  {
    ReservedRunFile reserved = ReservedRunFile::In(folder_ / "runs", 100'000);
    EXPECT_TRUE(RunFileIsLocked(reserved.path()));
    EXPECT_EQ(std::filesystem::file_size(reserved.path()), 0U);
    reserved.Rename(folder_ / "runs" / "unused.flexarm");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "runs" / "unused.flexarm"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "runs"));
  ReservedRunFile reserved = ReservedRunFile::In(folder_, 100'000);
  reserved.Rename(File());
  {
    RunWriter writer(std::move(reserved), MakeInfo());
    EXPECT_EQ(writer.Name(), File().string());
    writer.Tick(MakeTick(1));
    writer.Close("{}");
  }
  EXPECT_EQ(RunReader(File()).ReadAll().tick.size(), 1U);
}

TEST_F(RunRecoveryTest, AReservedFileNeverTakesTheNameOfAnother) {
  WriteText(File(), "precious");
  ReservedRunFile reserved = ReservedRunFile::In(folder_, 0);
  const std::string error = MessageOf<RunLogError>([&] { reserved.Rename(File()); });
  EXPECT_NE(error.find("already exists"), std::string::npos) << error;
  EXPECT_TRUE(reserved.is_valid());
  reserved.Rename(File("other.flexarm"));
  EXPECT_EQ(Bytes(File()), "precious");
}

TEST_F(RunRecoveryTest, AFolderThatCannotHoldARunIsNamedWithItsCause) {
  WriteText(File("folder"), "a file, not a folder");
  const std::string error =
      MessageOf<RunLogError>([&] { ReservedRunFile::In(File("folder"), 100); });
  EXPECT_NE(error.find("/folder: "), std::string::npos) << error;
  EXPECT_NE(error.find("Not a directory"), std::string::npos) << error;
  EXPECT_FALSE(FreeBytes(File("nowhere")).has_value());
  EXPECT_GT(FreeBytes(folder_).value_or(0), 0U);
}

}  // namespace
}  // namespace flexarm
