// A program that ends before any single call that changes a file, from the first to the last of a
// run: the file alone then opens, holds all that was committed, and is recovered.

#include <sys/mman.h>
#include <sys/wait.h>

#include <algorithm>

#include "controller/runlog/blob.h"
#include "controller/runlog/run_recovery.h"
#include "tests/controller/runlog/faulty_calls.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

constexpr int kTicks = 90, kTicksACommit = 30;

// Of the process that writes: how many calls it may make, and what it has committed.
struct Progress {
  int calls_left;
  bool half;  // the last write is torn in the middle
  int committed;
  bool closed;
};
Progress* progress = nullptr;

CallFault EndBeforeCall(std::string_view, std::size_t bytes) {
  if (--progress->calls_left > 0) return {};
  if (progress->calls_left == 0 && progress->half && bytes > 1) {
    return {.error = EIO, .halves_write = true};
  }
  ::_exit(99);
}

void WriteRun(const std::filesystem::path& file) {
  RunWriter writer(file, MakeInfo());
  writer.Safety(MakeSafety(1, kIdleStatus, RequestKind::kArm));
  for (int tick = 1; tick <= kTicks; ++tick) {
    writer.Tick(MakeTick(tick));
    if (tick % kTicksACommit != 0) continue;
    writer.Commit();
    progress->committed = tick;
  }
  writer.Close("{}");
  progress->closed = true;
}

class CrashPointsTest : public RunLogTest {
 protected:
  void SetUp() override {
    RunLogTest::SetUp();
    progress = static_cast<Progress*>(::mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE,
                                             MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    ASSERT_NE(progress, MAP_FAILED);
  }
  void TearDown() override {
    ::munmap(progress, sizeof(Progress));
    RunLogTest::TearDown();
  }
  // @returns false once the run ended before the call
  bool EndBefore(int call, bool half) {
    *progress = {.calls_left = call, .half = half, .committed = 0, .closed = false};
    const pid_t child = ::fork();
    if (child == 0) {
      before_file_call = EndBeforeCall;
      WriteRun(File());
      ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status) == 99;
  }
  static void ExpectCommitted(const std::filesystem::path& file) {
    RunReader reader(file);
    EXPECT_TRUE(reader.DigestHolds());
    const RunContents run = reader.ReadAll();
    ASSERT_GE(run.tick.size(), static_cast<std::size_t>(progress->committed));
    for (std::size_t n = 0; n < run.tick.size(); ++n) {
      ASSERT_TRUE(SameBytes(run.tick[n].input, MakeTick(static_cast<int>(n) + 1).input));
    }
    ASSERT_EQ(run.info.config_text.empty(), false);
  }
  void CheckLeftOver() {
    const bool began = std::filesystem::exists(File()) && !std::filesystem::is_empty(File());
    ASSERT_TRUE(began || progress->committed == 0);
    if (began && progress->committed > 0) {
      const std::filesystem::path elsewhere = folder_ / "elsewhere";
      std::filesystem::create_directory(elsewhere);
      std::filesystem::copy_file(File(), elsewhere / "copy.flexarm");
      ExpectCommitted(elsewhere / "copy.flexarm");
      std::filesystem::remove_all(elsewhere);
    }
    RecoverRuns(folder_,
                [](bool is_error, const std::string& text) { EXPECT_FALSE(is_error) << text; });
    if (began && progress->committed > 0) {
      ExpectCommitted(File());
      EXPECT_TRUE(RunReader(File()).closed());
    }
    const auto files = std::distance(std::filesystem::directory_iterator(folder_), {});
    EXPECT_EQ(files, began ? 1 : 0) << "no auxiliary file is left";
    std::filesystem::remove(File());
  }
  void CheckEveryCall(bool half) {
    int call = 1;
    while (EndBefore(call, half)) {
      SCOPED_TRACE("before call " + std::to_string(call));
      CheckLeftOver();
      ASSERT_FALSE(HasFailure());
      ++call;
    }
    EXPECT_TRUE(progress->closed);
    EXPECT_GT(call, 20) << "it cannot have counted the calls of a run";
    ExpectCommitted(File());
  }
};

TEST_F(CrashPointsTest, EveryCallOfARunMayBeTheOneBeforeWhichItEnds) { CheckEveryCall(false); }

TEST_F(CrashPointsTest, EveryWriteOfARunMayBeTorn) { CheckEveryCall(true); }

}  // namespace
}  // namespace flexarm
