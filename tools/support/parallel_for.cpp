#include "tools/support/parallel_for.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace flexarm {
namespace {

class Crew {
 public:
  Crew(std::size_t count, const std::function<void(std::size_t)>& body, std::size_t jobs)
      : count_(count), body_(body) {
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    left_ = std::min(jobs == 0 ? cores : jobs, count);
    for (std::size_t i = left_; i > 0; --i) {
      workers_.emplace_back([this] { Work(); });
    }
  }

  void Wait(const std::function<void(std::size_t)>& progress) {
    using namespace std::chrono_literals;
    std::unique_lock lock(mutex_);
    while (left_ > 0) {
      ended_.wait_for(lock, 100ms, [this] { return left_ == 0; });
      if (left_ == 0) break;
      lock.unlock();
      if (progress) progress(done_);
      lock.lock();
    }
    lock.unlock();
    for (std::thread& worker : workers_) worker.join();
    if (progress) progress(done_);
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void Work() {
    for (std::size_t i = next_++; i < count_; i = next_++) {
      try {
        body_(i);
        ++done_;
      } catch (...) {
        const std::scoped_lock lock(mutex_);
        if (!error_) error_ = std::current_exception();
        next_ = count_;
      }
    }
    const std::scoped_lock lock(mutex_);
    --left_;
    ended_.notify_one();
  }

  std::size_t count_;
  const std::function<void(std::size_t)>& body_;
  std::atomic<std::size_t> next_ = 0, done_ = 0;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t left_ = 0;      // number of workers that have not ended
  std::exception_ptr error_;  // of the first body that threw
  std::vector<std::thread> workers_;
};

// ", 3 min 20 s left", extrapolated from the mean time of the pieces that are done.
std::string TimeLeft(std::chrono::steady_clock::time_point started, std::size_t done,
                     std::size_t count) {
  if (done == 0 || done == count) return {};
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started;
  const double pieces = static_cast<double>(count - done) / static_cast<double>(done);
  const auto left_s = std::llround(spent.count() * pieces);
  const std::string minutes = left_s < 60 ? "" : std::to_string(left_s / 60) + " min ";
  return ", " + minutes + std::to_string(left_s % 60) + " s left";
}

}  // namespace

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body,
                 const std::function<void(std::size_t)>& progress, std::size_t jobs) {
  Crew(count, body, jobs).Wait(progress);
}

std::function<void(std::size_t)> ProgressBar(const char* what, std::size_t count) {
  if (::isatty(STDERR_FILENO) == 0 || count == 0) return {};
  return [what, count, started = std::chrono::steady_clock::now()](std::size_t done) {
    constexpr std::size_t kWidth = 40;
    const std::size_t filled = kWidth * done / count;
    const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
    std::fprintf(stderr, "\r%s [%s] %zu of %zu%s\033[K%s", what, bar.c_str(), done, count,
                 TimeLeft(started, done, count).c_str(), done == count ? "\n" : "");
    std::fflush(stderr);
  };
}

}  // namespace flexarm
