#include "tools/bench_host/child_program.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tools/support/scratch_folder.h"

namespace flexarm {
namespace {

bool ComesTrue(const std::function<bool()>& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

// Its number, when it says so in the file `number`; 0: it has not.
pid_t NumberIn(const std::filesystem::path& folder) {
  pid_t number = 0;
  std::ifstream(folder / "number") >> number;
  return number;
}

bool IsGone(pid_t number) { return ::kill(number, 0) != 0 && errno == ESRCH; }

// A shell that says its number, in one step, and becomes a program that waits.
const std::vector<std::string> kWaits = {"sh", "-c",
                                         "echo $$ >new && mv new number && exec sleep 1000"};

TEST(BackgroundChild, EndsWithItsObjectAlsoByAnException) {
  const ScratchFolder scratch;
  pid_t number = 0;
  try {
    BackgroundChild child(kWaits, scratch.path());
    ASSERT_TRUE(ComesTrue([&] { return NumberIn(scratch.path()) != 0; }));
    number = NumberIn(scratch.path());
    child.RequireRunning();
    ASSERT_FALSE(IsGone(number));
    throw std::runtime_error("");
  } catch (const std::runtime_error&) {
    EXPECT_TRUE(IsGone(number));
  }
}

TEST(BackgroundChild, IsKilledIfItDoesNotEndWhenAsked) {
  const ScratchFolder scratch;
  pid_t number = 0;
  {
    BackgroundChild child(
        {"sh", "-c", "trap '' TERM; echo $$ >new && mv new number && exec sleep 1000"},
        scratch.path());
    ASSERT_TRUE(ComesTrue([&] { return NumberIn(scratch.path()) != 0; }));
    number = NumberIn(scratch.path());
  }
  EXPECT_TRUE(IsGone(number));
}

TEST(BackgroundChild, EndsAlsoIfItsStarterIsKilled) {
  const ScratchFolder scratch;
  const pid_t starter = ::fork();
  if (starter == 0) {
    BackgroundChild child(kWaits, scratch.path());
    for (;;) ::pause();
  }
  const bool started = ComesTrue([&] { return NumberIn(scratch.path()) != 0; });
  ::kill(starter, SIGKILL);
  ::waitpid(starter, nullptr, 0);
  ASSERT_TRUE(started);
  // Who adopts it need not collect it: a zombie has ended too.
  const pid_t number = NumberIn(scratch.path());
  EXPECT_TRUE(ComesTrue([number] {
    std::ifstream status("/proc/" + std::to_string(number) + "/stat");
    std::string pid, name, state;
    return !(status >> pid >> name >> state) || state == "Z";
  }));
}

TEST(BackgroundChild, OneThatHasEndedIsNamedWithItsReason) {
  const ScratchFolder scratch;
  BackgroundChild child({"sh", "-c", "echo no room >&2; exit 3"}, scratch.path());
  const auto reason = [&child]() -> std::string {
    try {
      child.RequireRunning();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  ASSERT_TRUE(ComesTrue([&] { return !reason().empty(); }));
  EXPECT_EQ(reason(), "sh has ended: no room");
  EXPECT_THROW(BackgroundChild({"no-such-program"}, scratch.path()), std::runtime_error);
}

}  // namespace
}  // namespace flexarm
