// What the threads of the executor are: policy, priority, mode of floating point, and name.

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "tests/controller/realtime/recording_task.h"
#include "tests/support/fifo_permitted.h"
#include "tests/support/sanitizer.h"

namespace flexarm {
namespace {

struct SchedulingTask final : RecordingTask {
  using RecordingTask::RecordingTask;
  void Body(const Activation&) noexcept override {
    policy = sched_getscheduler(0);
    sched_param parameters{};
    sched_getparam(0, &parameters);
    priority = parameters.sched_priority;
    volatile double smallest_normal = std::numeric_limits<double>::min();
    denormals_flushed = smallest_normal / 2.0 == 0.0;
  }
  int policy = -1;
  int priority = -1;
  bool denormals_flushed = false;
};

TEST(RealtimeExecutor, GivesEachThreadItsPolicyPriorityAndFloatMode) {
  if (!FifoPermitted(80)) GTEST_SKIP() << "SCHED_FIFO is not permitted here";
  SchedulingTask control(Every(5 * kMs, 80));
  SchedulingTask recorder(Every(5 * kMs, 0));
  RealtimeExecutor executor(true);
  executor.Add(control);
  executor.Add(recorder);
  RunFor(executor, MonotonicNow() + kLeadNs, 1);
  EXPECT_EQ(control.policy, SCHED_FIFO);
  EXPECT_EQ(control.priority, 80);
  EXPECT_TRUE(control.denormals_flushed);
  EXPECT_EQ(recorder.policy, SCHED_OTHER);
  EXPECT_TRUE(recorder.denormals_flushed);
}

TEST(RealtimeExecutor, WithoutFifoEveryThreadIsOrdinary) {
  SchedulingTask control(Every(5 * kMs, 80));
  RealtimeExecutor executor(false);
  executor.Add(control);
  RunFor(executor, MonotonicNow() + kLeadNs, 1);
  EXPECT_EQ(control.policy, SCHED_OTHER);
}

class NamedTask final : public RecordingTask {
 public:
  explicit NamedTask(const char* name) : RecordingTask(Named(name)) {}
  void Body(const Activation&) noexcept override {
    pthread_getname_np(pthread_self(), thread_name.data(), thread_name.size());
  }

  std::array<char, 16> thread_name{};

 private:
  static Traits Named(const char* name) {
    Traits traits = Every(5 * kMs);
    traits.name = name;
    return traits;
  }
};

TEST(RealtimeExecutor, NamesEachThreadAndKeepsTheEndOfALongName) {
  NamedTask shortest("operator"), longest("fifteen-letters"), first("strain-amplifier-1"),
      second("strain-amplifier-2");
  RealtimeExecutor executor(false);
  for (NamedTask* task : {&shortest, &longest, &first, &second}) executor.Add(*task);
  RunFor(executor, MonotonicNow() + kLeadNs, 1);
  EXPECT_STREQ(shortest.thread_name.data(), "operator");
  EXPECT_STREQ(longest.thread_name.data(), "fifteen-letters");
  EXPECT_STREQ(first.thread_name.data(), "strain-a~fier-1");
  EXPECT_STREQ(second.thread_name.data(), "strain-a~fier-2");
}

// In a child process without any right: exits with 7 and the message if Start refuses.
[[noreturn]] void StartWithoutRights() {
  const rlimit none{.rlim_cur = 0, .rlim_max = 0};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || (geteuid() == 0 && setuid(65534) != 0)) _exit(3);
  RecordingTask task(Every(5 * kMs, 80));
  RealtimeExecutor executor(true);
  executor.Add(task);
  try {
    executor.Start(MonotonicNow() + kLeadNs, 20 * kMs);
  } catch (const std::runtime_error& error) {
    fprintf(stderr, "%s\n", error.what());
    _exit(7);
  }
  _exit(0);  // ran as an ordinary thread: wrong
}

TEST(RealtimeExecutorDeathTest, ThrowsWhenFifoIsNotPermitted) {
  if (kThreadSanitizer) {
    GTEST_SKIP() << "setuid never returns because of the thread sanitizer's own thread";
  }
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(StartWithoutRights(), testing::ExitedWithCode(7),
              "'test' with SCHED_FIFO priority 80.*LimitRTPRIO.*--without-realtime");
}

}  // namespace
}  // namespace flexarm
