#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace flexarm {

/// Makes calls after the same delay each, in the order in which they were asked for, on a thread of
/// its own.
class DelayedCalls {
 public:
  /// @param most  that wait at a time
  DelayedCalls(std::chrono::milliseconds delay, std::size_t most);
  ~DelayedCalls();
  DelayedCalls(const DelayedCalls&) = delete;
  DelayedCalls& operator=(const DelayedCalls&) = delete;

  /// Any thread. @returns false: too many wait, or it is closed; then there is no call
  bool Call(std::function<void()> what);

  /// Makes the calls that wait at once, and returns after the last one. Not on the calls' thread.
  void Close();

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    Clock::time_point due;
    std::function<void()> what;
  };

  void Run();

  std::chrono::milliseconds delay_;
  std::size_t most_;
  std::mutex mutex_;  // of what follows
  std::condition_variable news_;
  std::deque<Waiting> waiting_;
  bool closed_ = false;
  std::thread thread_;
};

}  // namespace flexarm
