// Does once, on a thread named `control`, what a real-time thread must not do: one of the arguments
//   heap, system-call, lock, page-fault, wait, crash, or nothing.
// RealtimeExecutor runs the thread, as in the daemon; rtguard must end the process.

#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

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

class Violating final : public Task {
 public:
  explicit Violating(const char* what) : what_(what) {
    page_ = static_cast<char*>(
        mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    munlock(page_, kPage);
    madvise(page_, kPage, MADV_DONTNEED);  // its next use is a page fault
  }

  Traits traits() const noexcept override {
    return {.name = "control", .period_ns = kMs, .phase_ns = 0, .deadline_ns = kMs, .priority = 0};
  }

  void Run(const Activation& activation) noexcept override {
    if (activation.due_ns < 50 * kMs || done_) return;
    done_ = true;
    if (Is("heap")) kept_ = std::make_unique<int>(1);
    if (Is("system-call")) syscall(SYS_getppid);
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
  }

  std::mutex& mutex() { return mutex_; }

 private:
  bool Is(const char* what) const { return std::strcmp(what_, what) == 0; }

  const char* what_;
  char* page_;
  std::unique_ptr<int> kept_;
  std::mutex mutex_;
  bool done_ = false;
};

int Run(const char* what) {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    std::fprintf(stderr, "rtguard_violations: memory cannot be locked here\n");
    return kSkipped;
  }
  Violating task(what);
  const std::lock_guard<std::mutex> held(task.mutex());
  RealtimeExecutor executor(false);
  executor.Add(task);
  executor.Start(MonotonicNow());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  executor.RequestStop();
  executor.Join();
  return 0;
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: rtguard_violations WHAT\n");
    return 2;
  }
  return flexarm::Run(argv[1]);
}
