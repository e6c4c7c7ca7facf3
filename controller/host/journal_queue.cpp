#include "controller/host/journal_queue.h"

#include <pthread.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

namespace flexarm {
namespace {

JournalLine GapLine(std::uint64_t dropped, std::chrono::system_clock::time_point at) {
  return {
      .is_error = true,
      .text = std::to_string(dropped) + " lines dropped: they came faster than this log is read",
      .at = at};
}

}  // namespace

struct JournalQueue::Shared {
  struct QueuedLine {
    JournalLine line;
    std::uint64_t dropped_before;  // lines lost between the previous one and this
  };

  Shared(Write to_write, std::size_t to_depth) : write(std::move(to_write)), depth(to_depth) {}

  const Write write;
  const std::size_t depth;
  std::mutex mutex;  // guards what follows; never held during `write`
  std::condition_variable changed;
  std::deque<QueuedLine> lines;
  std::uint64_t dropped = 0;  // since the last line of `lines`
  std::chrono::system_clock::time_point dropped_at;
  bool closing = false;
  bool written = false;  // the thread has written everything and ended
};

JournalQueue::JournalQueue(Write write, std::size_t depth)
    : shared_(std::make_shared<Shared>(std::move(write), depth)) {}

JournalQueue::~JournalQueue() {
  Start();
  std::unique_lock lock(shared_->mutex);
  shared_->closing = true;
  shared_->changed.notify_all();
  shared_->changed.wait_for(lock, kFlushLimit, [this] { return shared_->written; });
}

void JournalQueue::Start() {
  if (started_) return;
  started_ = true;
  std::thread([shared = shared_] { WriteAll(shared); }).detach();
}

void JournalQueue::Push(JournalLine line) {
  const std::lock_guard lock(shared_->mutex);
  if (shared_->lines.size() >= shared_->depth) {
    ++shared_->dropped;
    shared_->dropped_at = line.at;
    return;
  }
  const std::uint64_t dropped_before = std::exchange(shared_->dropped, 0);
  shared_->lines.push_back({.line = std::move(line), .dropped_before = dropped_before});
  shared_->changed.notify_all();
}

void JournalQueue::WriteAll(const std::shared_ptr<Shared>& shared) {
  pthread_setname_np(pthread_self(), "journal");
  std::unique_lock lock(shared->mutex);
  for (;;) {
    shared->changed.wait(lock, [&] { return shared->closing || !shared->lines.empty(); });
    if (shared->lines.empty()) break;
    const Shared::QueuedLine next = std::move(shared->lines.front());
    shared->lines.pop_front();
    lock.unlock();
    if (next.dropped_before > 0) shared->write(GapLine(next.dropped_before, next.line.at));
    shared->write(next.line);
    lock.lock();
  }
  if (const std::uint64_t dropped = std::exchange(shared->dropped, 0); dropped > 0) {
    lock.unlock();
    shared->write(GapLine(dropped, shared->dropped_at));
    lock.lock();
  }
  shared->written = true;
  shared->changed.notify_all();
}

}  // namespace flexarm
