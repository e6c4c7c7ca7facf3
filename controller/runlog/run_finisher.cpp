#include "controller/runlog/run_finisher.h"

#include <chrono>
#include <utility>

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

bool RunFinisher::Try() {
  std::erase_if(runs_, [this](Waiting& waiting) {
    const std::string error = waiting.run.Finish();
    const bool changed = std::exchange(waiting.error, error) != error;
    if (error.empty()) {
      report_(false, "run closed: " + waiting.run.path().string());
      if (reports_ != nullptr) reports_->Closed(waiting.run.path());
    } else if (changed) {
      report_(true, error + "; its records are kept, and this is tried again");
    }
    return error.empty();
  });
  const bool reported = reports_ == nullptr || reports_->Try();
  return runs_.empty() && reported;
}

}  // namespace flexarm
