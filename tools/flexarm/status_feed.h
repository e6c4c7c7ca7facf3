#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

#include "controller/runlog/file_descriptor.h"
#include "tools/daemon_client/daemon_client.h"
#include "tools/status/watch_rows.h"

namespace flexarm {

/// Asks the daemon for its status once a period, on a thread of its own, so that a daemon that
/// stands still does not hold up keys, signals and the clock of a screen. It goes on asking when
/// there is no answer.
class StatusFeed {
 public:
  /// @param daemon  outlives this
  StatusFeed(const DaemonClient& daemon, double period_s);

  /// Readable when an answer, or a reason why there is none, has come since the last Take.
  int descriptor() const { return news_.get(); }
  /// Any thread. The last good answer with its age now, and why the newest one is none.
  WatchedStatus Take();

 private:
  using Clock = std::chrono::steady_clock;

  void Run(const std::stop_token& stop);
  void Ask();

  const DaemonClient& daemon_;
  std::chrono::nanoseconds period_;
  FileDescriptor news_;  // an eventfd
  std::mutex mutex_;     // of what follows
  std::condition_variable_any ended_;
  WatchedStatus newest_;
  Clock::time_point came_;
  std::jthread thread_;
};

}  // namespace flexarm
