#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace flexarm {

/// Real-time permissions of this process on this kernel.
struct RealtimeHost {
  static constexpr std::uint64_t kUnlimited = UINT64_MAX;

  int fifo_error;                     ///< errno of a trial SCHED_FIFO thread; 0: permitted
  int fifo_priority;                  ///< priority that was tried
  std::uint64_t rtprio_limit;         ///< RLIMIT_RTPRIO
  std::uint64_t memlock_limit_bytes;  ///< RLIMIT_MEMLOCK
  std::uint64_t rttime_limit_us;      ///< RLIMIT_RTTIME; should be kUnlimited
  std::int64_t
      throttle_runtime_us;     ///< run time per 1 s; -1: no throttling; INT64_MIN: not readable
  std::string kernel_version;  ///< uname -v
};

/// The host does not permit real time; what() gives each cause and its remedy, one per line.
class RealtimeRejectedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Starts and joins one SCHED_FIFO thread of `fifo_priority` to test whether it is permitted.
RealtimeHost ReadRealtimeHost(int fifo_priority);

/// True if the kernel says that it is PREEMPT_RT.
bool IsPreemptRt(const RealtimeHost& host);

/// One line per finding, good and bad, for the log. Never throws RealtimeRejectedError.
std::vector<std::string> RealtimeFindings(const RealtimeHost& host);

/// Prepares the process for real time, once, from the main thread, before any other is started:
/// checks SCHED_FIFO up to `fifo_priority`, locks all memory present and future, and keeps malloc
/// from returning memory to the kernel.
/// @returns RealtimeFindings of this host
/// @throws RealtimeRejectedError  if anything is not permitted. Then nothing has changed except
/// that the memory is locked.
std::vector<std::string> PrepareRealtime(int fifo_priority);

}  // namespace flexarm
