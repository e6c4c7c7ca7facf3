#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string_view>

namespace flexarm {

/// Counts requests with a wrong token, and writes them to standard error: the first at once, then
/// at most one line each ten seconds. Thread: Report is the server's; count is any.
class WrongTokens {
 public:
  void Report(std::string_view path);
  std::uint64_t count() const { return count_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::atomic<std::uint64_t> count_ = 0;
  Clock::time_point next_line_{};
};

}  // namespace flexarm
