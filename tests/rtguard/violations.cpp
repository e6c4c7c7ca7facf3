// Does once, on a thread of the given name, what a real-time thread must not do: one of the
// arguments
//   heap, system-call, path, lock, page-fault, wait, switch, crash, or nothing;
//   descriptor: only a bus thread may.
// RealtimeExecutor runs the thread, as in the daemon; rtguard must end the process.

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <memory>
#include <mutex>
#include <thread>

#include "controller/realtime/clock.h"
#include "controller/realtime/realtime_executor.h"

namespace flexarm {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::size_t kPage = 4096;
constexpr int kSkipped = 77;

long ForcedSwitches() {
  rusage now{};
  getrusage(RUSAGE_THREAD, &now);
  return now.ru_nivcsw;
}

// From now on every thread of this process has the same core.
void KeepToOneCore() {
  cpu_set_t core;
  CPU_ZERO(&core);
  CPU_SET(static_cast<std::size_t>(sched_getcpu()), &core);
  sched_setaffinity(0, sizeof(core), &core);
}

// A thread that computes as long as it is wanted, and sleeps otherwise.
class Competitor {
 public:
  Competitor() : thread_([this] { Run(); }) {}
  ~Competitor() {
    ends_ = true;
    thread_.join();
  }
  Competitor(const Competitor&) = delete;
  Competitor& operator=(const Competitor&) = delete;

  void Want(bool wanted) { wanted_ = wanted; }

 private:
  void Run() {
    while (!ends_) {
      if (!wanted_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  std::atomic<bool> wanted_{false};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

class Violating final : public Task {
 public:
  Violating(const char* what, const char* thread, Competitor* competitor)
      : what_(what), thread_(thread), competitor_(competitor) {
    page_ = static_cast<char*>(
        mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    munlock(page_, kPage);
    madvise(page_, kPage, MADV_DONTNEED);  // its next use is a page fault
  }

  Traits traits() const noexcept override {
    return {.name = thread_, .period_ns = kMs, .phase_ns = 0, .deadline_ns = kMs, .priority = 0};
  }

  void Run(const Activation& activation) noexcept override {
    if (done_) is_over_ = true;
    if (activation.due_ns < 50 * kMs || done_) return;
    done_ = true;
    if (Is("heap")) kept_ = std::make_unique<int>(1);
    if (Is("system-call")) syscall(SYS_getppid);
    struct stat properties{};
    if (Is("descriptor")) fstat(STDERR_FILENO, &properties);
    if (Is("path")) stat("/dev/null", &properties);
    if (Is("lock")) mutex_.lock();  // another thread has it
    if (Is("page-fault")) page_[0] = 1;
    if (Is("crash")) static_cast<void>(raise(SIGSEGV));
    if (Is("wait")) {
      // A system call of its own, below every library: it is on the list, and waits.
      const timespec moment{.tv_sec = 0, .tv_nsec = 1'000'000};
      long result = SYS_clock_nanosleep;
      asm volatile("syscall"
                   : "+a"(result)
                   : "D"(CLOCK_MONOTONIC), "S"(0), "d"(&moment)
                   : "rcx", "r11", "memory");
    }
    if (Is("switch")) ShareTheCore();
  }

  std::mutex& mutex() { return mutex_; }

  /// The activation after the violation runs: the sleep between them was no violation.
  bool is_over() const { return is_over_; }

 private:
  // Until the kernel has given the core to the other thread, which needs no real time.
  void ShareTheCore() {
    const long before = ForcedSwitches();
    const std::int64_t begin_ns = MonotonicNow();
    competitor_->Want(true);
    while (ForcedSwitches() == before && MonotonicNow() - begin_ns < 20'000 * kMs) {
    }
    competitor_->Want(false);
  }

  bool Is(const char* what) const { return std::strcmp(what_, what) == 0; }

  const char* what_;
  const char* thread_;
  Competitor* competitor_;
  char* page_;
  std::unique_ptr<int> kept_;
  std::mutex mutex_;
  bool done_ = false;
  std::atomic<bool> is_over_{false};
};

int Run(const char* what, const char* thread) {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    std::fprintf(stderr, "rtguard_violations: memory cannot be locked here\n");
    return kSkipped;
  }
  KeepToOneCore();
  Competitor competitor;
  Violating task(what, thread, &competitor);
  const std::lock_guard<std::mutex> held(task.mutex());
  RealtimeExecutor executor(false);
  executor.Add(task);
  executor.Start(MonotonicNow());
  while (!task.is_over()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  executor.RequestStop();
  executor.Join();
  return 0;
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: rtguard_violations WHAT THREAD\n");
    return 2;
  }
  return flexarm::Run(argv[1], argv[2]);
}
