#include "controller/runlog/run_finisher.h"

#include <chrono>
#include <filesystem>
#include <utility>
#include <vector>

namespace flexarm {

void RunFinisher::Start() {
  thread_ = std::thread([this] { Work(); });
}

void RunFinisher::Add(EndedRun run) {
  {
    const std::lock_guard lock(mutex_);
    added_.push_back(std::move(run));
  }
  changed_.notify_one();
}

void RunFinisher::Stop() {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(stopping_, true)) return;
  }
  changed_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  } else {
    TakeAdded();
    Try();
  }
}

void RunFinisher::Work() {
  bool all_finished = true, stopping = false;
  while (!stopping) {
    {
      std::unique_lock lock(mutex_);
      const auto ready = [this] { return stopping_ || !added_.empty(); };
      if (all_finished) {
        changed_.wait(lock, ready);
      } else {
        changed_.wait_for(lock, std::chrono::seconds(1), ready);
      }
      stopping = stopping_;
    }
    TakeAdded();
    all_finished = Try();
  }
}

void RunFinisher::TakeAdded() {
  const std::lock_guard lock(mutex_);
  while (!added_.empty()) {
    runs_.push_back({.run = std::move(added_.front()), .error = {}});
    added_.pop_front();
  }
}

// Reports come last: a run that waits keeps the space that was reserved for it.
bool RunFinisher::Try() {
  std::vector<std::filesystem::path> closed;
  std::erase_if(runs_, [&](Waiting& waiting) {
    const std::string error = waiting.run.Finish();
    const bool changed = std::exchange(waiting.error, error) != error;
    if (error.empty()) {
      report_(false, "run closed: " + waiting.run.path().string());
      closed.push_back(waiting.run.path());
    } else if (changed) {
      report_(true, error + "; its records are kept, and this is tried again");
    }
    return error.empty();
  });
  if (reports_ == nullptr) return runs_.empty();
  for (const std::filesystem::path& log : closed) reports_->Closed(log);
  return reports_->Try() && runs_.empty();
}

}  // namespace flexarm
