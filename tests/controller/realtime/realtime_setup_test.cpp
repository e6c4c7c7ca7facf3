#include "controller/realtime/realtime_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/sanitizer.h"

namespace flexarm {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

RealtimeHost GoodHost() {
  return {.fifo_error = 0,
          .fifo_priority = 90,
          .rtprio_limit = 99,
          .memlock_limit_bytes = RealtimeHost::kUnlimited,
          .rttime_limit_us = RealtimeHost::kUnlimited,
          .throttle_runtime_us = -1,
          .kernel_version = "#1 SMP PREEMPT_RT Debian 6.1"};
}

TEST(RealtimeFindings, ReportWhatIsPermitted) {
  const auto findings = RealtimeFindings(GoodHost());
  EXPECT_THAT(findings, Contains(AllOf(HasSubstr("PREEMPT_RT"), Not(HasSubstr("not PREEMPT_RT")))));
  EXPECT_THAT(findings, Contains("SCHED_FIFO priority 90: permitted"));
  EXPECT_THAT(findings, Contains("real-time throttling: off"));
  EXPECT_THAT(findings, Contains("RLIMIT_RTTIME: unlimited"));
}

TEST(RealtimeFindings, ReportEachProblemWithItsRemedy) {
  RealtimeHost host = GoodHost();
  host.kernel_version = "#1 SMP PREEMPT_DYNAMIC";
  host.fifo_error = EPERM;
  host.rtprio_limit = 0;
  host.throttle_runtime_us = 950'000;
  host.rttime_limit_us = 200'000;
  const auto findings = RealtimeFindings(host);
  EXPECT_THAT(findings, Contains(HasSubstr("not PREEMPT_RT")));
  EXPECT_THAT(findings, Contains(AllOf(HasSubstr("RLIMIT_RTPRIO is 0"), HasSubstr("LimitRTPRIO=99"),
                                       HasSubstr("--without-realtime"))));
  EXPECT_THAT(findings, Contains(HasSubstr("950000 us of each 1 s")));
  EXPECT_THAT(findings, Contains(AllOf(HasSubstr("200000 us"), HasSubstr("LimitRTTIME=infinity"))));
  host.throttle_runtime_us = INT64_MIN;
  EXPECT_THAT(RealtimeFindings(host), Contains(HasSubstr("not readable")));
}

TEST(ReadRealtimeHost, ReadsThisKernel) {
  const RealtimeHost host = ReadRealtimeHost(50);
  EXPECT_FALSE(host.kernel_version.empty());
  EXPECT_EQ(host.fifo_priority, 50);
}

void GiveUpRights() {
  const rlimit none{.rlim_cur = 0, .rlim_max = 0};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_MEMLOCK, &none) != 0 ||
      (geteuid() == 0 && setuid(65534) != 0)) {
    _exit(3);
  }
}

// In a child process: the exit code gives the result.
[[noreturn]] void Prepare() {
  try {
    PrepareRealtime(90);
  } catch (const RealtimeRejectedError& refused) {
    std::string text = refused.what();
    for (char& c : text) c = c == '\n' ? ' ' : c;  // one line for the matcher
    std::fprintf(stderr, "%s\n", text.c_str());
    _exit(7);
  }
  _exit(0);
}

TEST(PrepareRealtimeDeathTest, RefusesWithEveryCauseAndRemedyWhenNothingIsPermitted) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer intercepts mlockall and mallopt";
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        GiveUpRights();
        Prepare();
      },
      testing::ExitedWithCode(7),
      "RLIMIT_RTPRIO is 0.*LimitRTPRIO=99.*--without-realtime.*RLIMIT_MEMLOCK is 0 bytes.*"
      "LimitMEMLOCK=infinity");
}

// True if a block that another thread allocates lies on the heap below the break, which is locked.
bool AllThreadsShareTheHeap() {
  bool shared = false;
  std::thread other([&shared] {
    const std::vector<char> block(1'000'000);
    shared =
        reinterpret_cast<std::uintptr_t>(block.data()) < reinterpret_cast<std::uintptr_t>(sbrk(0));
  });
  other.join();
  return shared;
}

[[noreturn]] void PrepareAndLookAtTheHeap() {
  PrepareRealtime(90);
  _exit(AllThreadsShareTheHeap() ? 0 : 8);
}

TEST(PrepareRealtimeDeathTest, AllThreadsAllocateFromTheLockedHeap) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer intercepts mlockall and mallopt";
  if (geteuid() != 0 || ReadRealtimeHost(90).fifo_error != 0) {
    GTEST_SKIP() << "real time is not permitted here";
  }
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(PrepareAndLookAtTheHeap(), testing::ExitedWithCode(0), "");
}

TEST(PrepareRealtimeDeathTest, SucceedsWhereFifoAndLockingArePermitted) {
  if (kSanitized) GTEST_SKIP() << "a sanitizer intercepts mlockall and mallopt";
  if (geteuid() != 0 || ReadRealtimeHost(90).fifo_error != 0) {
    GTEST_SKIP() << "real time is not permitted here";
  }
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(Prepare(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace flexarm
