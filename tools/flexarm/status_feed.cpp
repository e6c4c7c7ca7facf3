#include "tools/flexarm/status_feed.h"

#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <exception>
#include <string>
#include <system_error>
#include <utility>

#include "tools/status/reply.h"

namespace flexarm {
namespace {

// A daemon that runs answers within a look of its operator task, 10 ms.
constexpr double kAnswerWithin_s = 1.0;

FileDescriptor OpenNews() {
  FileDescriptor news(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!news.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
  return news;
}

}  // namespace

StatusFeed::StatusFeed(const DaemonClient& daemon, double period_s)
    : daemon_(daemon),
      period_(std::llround(period_s * 1e9)),
      news_(OpenNews()),
      thread_([this](const std::stop_token& stop) { Run(stop); }) {}

WatchedStatus StatusFeed::Take() {
  eventfd_t count = 0;
  eventfd_read(news_.get(), &count);
  const std::scoped_lock lock(mutex_);
  WatchedStatus taken = newest_;
  taken.age_s = std::chrono::duration<double>(Clock::now() - came_).count();
  return taken;
}

void StatusFeed::Run(const std::stop_token& stop) {
  Clock::time_point next = Clock::now();
  while (!stop.stop_requested()) {
    Ask();
    eventfd_write(news_.get(), 1);
    next = std::max(next + period_, Clock::now());
    std::unique_lock lock(mutex_);
    ended_.wait_until(lock, stop, next, [] { return false; });
  }
}

void StatusFeed::Ask() {
  Reply answer;
  std::string problem;
  try {
    answer = daemon_.Ask({{"command", "status"}}, kAnswerWithin_s);
    if (!FlagIn(answer, "ok")) problem = TextIn(answer, "error", "the daemon refuses");
  } catch (const std::exception& error) {
    problem = error.what();
  }
  const std::scoped_lock lock(mutex_);
  newest_.no_answer = std::move(problem);
  if (!newest_.no_answer.empty()) return;
  newest_.status = std::move(answer);
  came_ = Clock::now();
}

}  // namespace flexarm
