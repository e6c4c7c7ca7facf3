#include "controller/host/journal_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using Clock = std::chrono::steady_clock;

// Keeps what is written; can be blocked, as a full pipe is.
class Log {
 public:
  JournalQueue::Write Writer() {
    return [kept = kept_](const JournalLine& line) {
      kept->begun.Set();
      if (kept->gate.valid()) kept->gate.wait();
      const std::lock_guard lock(kept->mutex);
      kept->lines.push_back(line);
    };
  }
  void Block() { kept_->gate = open_.get_future().share(); }
  void Open() { open_.set_value(); }
  // Until the first line is being written.
  void WaitForWriter() { kept_->begun.future.wait(); }

  std::vector<JournalLine> lines() const {
    const std::lock_guard lock(kept_->mutex);
    return kept_->lines;
  }
  std::vector<std::string> texts() const {
    std::vector<std::string> all;
    for (const JournalLine& line : lines()) all.push_back(line.text);
    return all;
  }

 private:
  struct Begun {
    std::promise<void> promise;
    std::future<void> future = promise.get_future();
    std::once_flag once;
    void Set() {
      std::call_once(once, [this] { promise.set_value(); });
    }
  };
  struct Kept {  // outlives the test if the thread hangs
    Begun begun;
    std::shared_future<void> gate;
    std::mutex mutex;
    std::vector<JournalLine> lines;
  };
  std::promise<void> open_;
  std::shared_ptr<Kept> kept_ = std::make_shared<Kept>();
};

JournalLine Said(const std::string& text) { return {.is_error = false, .text = text, .at = {}}; }

TEST(JournalQueue, WritesEveryLineInOrderBeforeItEnds) {
  Log log;
  {
    JournalQueue queue(log.Writer());
    queue.Push(Said("before the start"));
    queue.Start();
    queue.Push(Said("after it"));
  }
  EXPECT_THAT(log.texts(), ElementsAre("before the start", "after it"));
}

TEST(JournalQueue, WritesTheLinesOfAQueueThatWasNeverStarted) {
  Log log;
  {
    JournalQueue(log.Writer()).Push(Said("why it does not start"));
  }
  EXPECT_THAT(log.texts(), ElementsAre("why it does not start"));
}

TEST(JournalQueue, KeepsTheInstantOfTheReport) {
  Log log;
  const std::chrono::system_clock::time_point at{std::chrono::hours(1)};
  {
    JournalQueue(log.Writer()).Push({.is_error = true, .text = "x", .at = at});
  }
  ASSERT_THAT(log.lines(), SizeIs(1));
  EXPECT_EQ(log.lines()[0].at, at);
  EXPECT_TRUE(log.lines()[0].is_error);
}

TEST(JournalQueue, DropsAndCountsWhatDoesNotFitAndNeverWaits) {
  Log log;
  log.Block();
  {
    JournalQueue queue(log.Writer(), 2);
    queue.Start();
    queue.Push(Said("being written"));
    log.WaitForWriter();
    for (const char* text : {"a", "b", "lost", "lost", "lost"}) queue.Push(Said(text));
    log.Open();
    while (log.lines().size() < 3) std::this_thread::yield();
    queue.Push(Said("c"));
  }
  EXPECT_THAT(log.texts(),
              ElementsAre("being written", "a", "b", HasSubstr("3 lines dropped"), "c"));
  EXPECT_TRUE(log.lines()[3].is_error);
}

TEST(JournalQueue, CountsTheLinesDroppedBeforeItEnds) {
  Log log;
  {
    JournalQueue queue(log.Writer(), 1);
    for (const char* text : {"a", "lost", "lost"}) queue.Push(Said(text));
  }
  EXPECT_THAT(log.texts(), ElementsAre("a", HasSubstr("2 lines dropped")));
}

TEST(JournalQueue, EndsThoughTheLogIsBlockedForEver) {
  Log log;
  log.Block();
  const auto began = Clock::now();
  {
    JournalQueue queue(log.Writer());
    queue.Start();
    queue.Push(Said("hangs"));
    log.WaitForWriter();
  }
  EXPECT_GE(Clock::now() - began, JournalQueue::kFlushLimit) << "it did not wait for the log";
  EXPECT_THAT(log.texts(), SizeIs(0));
  log.Open();  // the thread, which was left behind, ends
}

}  // namespace
}  // namespace flexarm
