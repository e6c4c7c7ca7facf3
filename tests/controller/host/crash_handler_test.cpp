#include "controller/host/crash_handler.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <thread>

#include "controller/realtime/alternate_stack.h"
#include "tests/support/sanitizer.h"

namespace flexarm {
namespace {

constexpr std::size_t kPageBytes = 4096;

/// The end that the signal has by default; a sanitizer reports it and ends with a code instead.
class EndsBy {
 public:
  explicit EndsBy(int signal) : signal_(signal) {}
  bool operator()(int status) const {
    if (WIFSIGNALED(status)) return WTERMSIG(status) == signal_;
    return kSanitized && WEXITSTATUS(status) != 0;
  }

 private:
  int signal_;
};

void Say(const char* text) {
  ASSERT_EQ(write(STDERR_FILENO, text, std::string(text).size()),
            static_cast<ssize_t>(std::string(text).size()));
}

void SayPowerOff(void* context) noexcept { Say(static_cast<const char*>(context)); }

// The text of the context is written when the power is taken away.
CrashHandler::PowerOff Told() {
  static std::string text = "POWER OFF;";
  return {.call = SayPowerOff, .context = text.data()};
}

class CrashHandlerDeathTest : public testing::TestWithParam<int> {
 protected:
  CrashHandlerDeathTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_P(CrashHandlerDeathTest, TakesThePowerAwayBeforeItSaysSoAndEndsTheProcess) {
  const int signal = GetParam();
  const std::string name = std::string("SIG") + sigabbrev_np(signal);
  EXPECT_EXIT(
      {
        const CrashHandler handler(Told());
        raise(signal);
      },
      EndsBy(signal),
      "^POWER OFF;flexarmd: " + name +
          " in thread '.*': relay and charge pump are off, the daemon ends\nPOWER OFF;");
}

INSTANTIATE_TEST_SUITE_P(For, CrashHandlerDeathTest, testing::ValuesIn(kCrashSignals),
                         [](const auto& tested) { return sigabbrev_np(tested.param); });

using CrashDeathTest = CrashHandlerDeathTest;

TEST_F(CrashDeathTest, OfAMemoryAccessNamesThreadAndAddress) {
  EXPECT_EXIT(
      {
        const CrashHandler handler(Told());
        void* page = mmap(nullptr, kPageBytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        std::thread([page] {
          pthread_setname_np(pthread_self(), "operator");
          *static_cast<volatile char*>(page) = 1;
        }).join();
      },
      EndsBy(SIGSEGV),
      "^POWER OFF;flexarmd: SIGSEGV in thread 'operator' at address 0x[0-9a-f]+00:");
}

// The `-shm` file of a log, shortened by another program.
TEST_F(CrashDeathTest, OfAMappedFileThatBecameShorter) {
  EXPECT_EXIT(
      {
        const CrashHandler handler(Told());
        std::FILE* file = std::tmpfile();
        ASSERT_EQ(ftruncate(fileno(file), kPageBytes), 0);
        void* page = mmap(nullptr, kPageBytes, PROT_READ, MAP_SHARED, fileno(file), 0);
        ASSERT_EQ(ftruncate(fileno(file), 0), 0);
        [[maybe_unused]] const char first = *static_cast<volatile char*>(page);
      },
      EndsBy(SIGBUS), "^POWER OFF;flexarmd: SIGBUS ");
}

// The compiler must keep each frame.
[[gnu::noinline]] int Fill(int depth) {
  std::array<volatile unsigned char, 1000> bytes{};
  bytes[static_cast<std::size_t>(depth) % bytes.size()] = 1;
  return depth < 0 ? 0 : Fill(depth + 1) + bytes[0];
}

TEST_F(CrashDeathTest, OfAStackThatOverflowedIsHandledOnAnother) {
  EXPECT_EXIT(
      {
        const CrashHandler handler(Told());
        std::thread([] {
          const AlternateStack stack;
          Fill(0);
        }).join();
      },
      EndsBy(SIGSEGV), "^POWER OFF;flexarmd: SIGSEGV ");
}

// A pipe that is not read: a write would wait for ever, and the process would never end.
TEST_F(CrashDeathTest, IsNotHeldByAFullPipe) {
  if (kThreadSanitizer) {
    GTEST_SKIP() << "the thread sanitizer itself reports to the full pipe, and waits";
  }
  EXPECT_EXIT(
      {
        int ends[2];
        ASSERT_EQ(pipe2(ends, O_NONBLOCK), 0);
        const std::string block(kPageBytes, 'x');
        while (write(ends[1], block.data(), block.size()) > 0) {
        }
        fcntl(ends[1], F_SETFL, 0);
        const CrashHandler handler({.call = [](void*) noexcept {}, .context = nullptr});
        dup2(ends[1], STDERR_FILENO);
        raise(SIGSEGV);
      },
      EndsBy(SIGSEGV), "");
}

TEST(CrashHandlerTest, LeavesTheEffectsOfBeforeBehind) {
  struct sigaction before{};
  struct sigaction after{};
  sigaction(SIGFPE, nullptr, &before);
  {
    const CrashHandler handler(Told());
  }
  sigaction(SIGFPE, nullptr, &after);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

}  // namespace
}  // namespace flexarm
