#include "tools/dashboard/delayed_calls.h"

#include <utility>

namespace flexarm {

DelayedCalls::DelayedCalls(std::chrono::milliseconds delay, std::size_t most)
    : delay_(delay), most_(most), thread_([this] { Run(); }) {}

DelayedCalls::~DelayedCalls() { Close(); }

bool DelayedCalls::Call(std::function<void()> what) {
  const std::scoped_lock lock(mutex_);
  if (closed_ || waiting_.size() >= most_) return false;
  waiting_.push_back({.due = Clock::now() + delay_, .what = std::move(what)});
  news_.notify_one();
  return true;
}

void DelayedCalls::Close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    news_.notify_one();
  }
  if (thread_.joinable()) thread_.join();
}

void DelayedCalls::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    news_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    news_.wait_until(lock, waiting_.front().due, [this] { return closed_; });
    const Waiting due = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    due.what();
    lock.lock();
  }
}

}  // namespace flexarm
