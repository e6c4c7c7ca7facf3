#include "controller/realtime/realtime_setup.h"

#include <malloc.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/utsname.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace flexarm {
namespace {

constexpr const char* kThrottleFile = "/proc/sys/kernel/sched_rt_runtime_us";
constexpr std::int64_t kNotReadable = INT64_MIN;

void* DoNothing(void*) noexcept { return nullptr; }

int TryFifoThread(int priority) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  pthread_attr_setschedpolicy(&attributes, SCHED_FIFO);
  const sched_param parameters{.sched_priority = priority};
  pthread_attr_setschedparam(&attributes, &parameters);
  pthread_t thread{};
  const int error = pthread_create(&thread, &attributes, &DoNothing, nullptr);
  pthread_attr_destroy(&attributes);
  if (error == 0) pthread_join(thread, nullptr);
  return error;
}

std::uint64_t SoftLimit(__rlimit_resource resource) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return 0;
  return limit.rlim_cur == RLIM_INFINITY ? RealtimeHost::kUnlimited : limit.rlim_cur;
}

std::string LimitText(std::uint64_t limit, const char* unit) {
  if (limit == RealtimeHost::kUnlimited) return "unlimited";
  std::string text = std::to_string(limit);
  text += unit;
  return text;
}

std::string FifoRefusal(const RealtimeHost& host) {
  return "SCHED_FIFO priority " + std::to_string(host.fifo_priority) + " is refused (" +
         std::strerror(host.fifo_error) + "; RLIMIT_RTPRIO is " + LimitText(host.rtprio_limit, "") +
         "): set LimitRTPRIO=99 in the systemd unit, run as root, or use --without-realtime";
}

std::string LockRefusal(const RealtimeHost& host, int error) {
  return std::string("locking the memory is refused (") + std::strerror(error) +
         "; RLIMIT_MEMLOCK is " + LimitText(host.memlock_limit_bytes, " bytes") +
         "): set LimitMEMLOCK=infinity in the systemd unit, run as root, or use "
         "--without-realtime";
}

}  // namespace

RealtimeHost ReadRealtimeHost(int fifo_priority) {
  utsname kernel{};
  const bool named = uname(&kernel) == 0;
  std::int64_t throttle_us = kNotReadable;
  if (std::ifstream file(kThrottleFile); !(file >> throttle_us)) throttle_us = kNotReadable;
  return {.fifo_error = TryFifoThread(fifo_priority),
          .fifo_priority = fifo_priority,
          .rtprio_limit = SoftLimit(RLIMIT_RTPRIO),
          .memlock_limit_bytes = SoftLimit(RLIMIT_MEMLOCK),
          .rttime_limit_us = SoftLimit(RLIMIT_RTTIME),
          .throttle_runtime_us = throttle_us,
          .kernel_version = named ? kernel.version : ""};
}

bool IsPreemptRt(const RealtimeHost& host) {
  return host.kernel_version.find("PREEMPT_RT") != std::string::npos ||
         host.kernel_version.find("PREEMPT RT") != std::string::npos;  // before Linux 5.4
}

std::vector<std::string> RealtimeFindings(const RealtimeHost& host) {
  std::vector<std::string> findings;
  findings.push_back("kernel: " + (host.kernel_version.empty() ? "unknown" : host.kernel_version) +
                     (IsPreemptRt(host)
                          ? " (PREEMPT_RT)"
                          : " (not PREEMPT_RT: wake-ups may be late by milliseconds)"));
  findings.push_back(host.fifo_error == 0 ? "SCHED_FIFO priority " +
                                                std::to_string(host.fifo_priority) + ": permitted"
                                          : FifoRefusal(host));
  if (host.throttle_runtime_us == kNotReadable) {
    findings.push_back(std::string("real-time throttling: unknown, ") + kThrottleFile +
                       " is not readable");
  } else if (host.throttle_runtime_us < 0) {
    findings.push_back("real-time throttling: off");
  } else {
    findings.push_back("real-time throttling: " + std::to_string(host.throttle_runtime_us) +
                       " us of each 1 s (" + kThrottleFile +
                       "); affects only a thread that needs more");
  }
  findings.push_back(
      host.rttime_limit_us == RealtimeHost::kUnlimited
          ? "RLIMIT_RTTIME: unlimited"
          : "RLIMIT_RTTIME: " + std::to_string(host.rttime_limit_us) +
                " us of CPU time without sleeping ends the process: set LimitRTTIME=infinity in "
                "the systemd unit");
  return findings;
}

std::vector<std::string> PrepareRealtime(int fifo_priority) {
  const RealtimeHost host = ReadRealtimeHost(fifo_priority);
  std::vector<std::string> refusals;
  if (host.fifo_error != 0) refusals.push_back(FifoRefusal(host));
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) refusals.push_back(LockRefusal(host, errno));
  // Freed memory stays in the process, and large blocks and those of all threads come from the one
  // locked heap, so that later allocations cause no page fault and no thread maps 64 MiB of its
  // own.
  if (mallopt(M_TRIM_THRESHOLD, -1) != 1 || mallopt(M_MMAP_MAX, 0) != 1 ||
      mallopt(M_ARENA_MAX, 1) != 1) {
    refusals.push_back(
        "malloc does not accept M_TRIM_THRESHOLD, M_MMAP_MAX and M_ARENA_MAX: run with the C "
        "library's own "
        "malloc, or use --without-realtime");
  }
  if (!refusals.empty()) {
    std::string text;
    for (const std::string& refusal : refusals)
      text.append(text.empty() ? "" : "\n").append(refusal);
    throw RealtimeRejectedError(text);
  }
  return RealtimeFindings(host);
}

}  // namespace flexarm
