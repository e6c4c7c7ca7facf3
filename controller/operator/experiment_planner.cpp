#include "controller/operator/experiment_planner.h"

#include <pthread.h>

#include <exception>
#include <utility>

#include "controller/realtime/alternate_stack.h"

namespace flexarm {

ExperimentPlanner::ExperimentPlanner() : thread_([this] { RunJobs(); }) {
  pthread_setname_np(thread_.native_handle(), "experiments");
}

ExperimentPlanner::~ExperimentPlanner() {
  Cancel();
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ExperimentPlanner::Begin(Job job) {
  Cancel();
  {
    const std::lock_guard lock(mutex_);
    newest_ = std::make_shared<Work>(Work{.job = std::move(job)});
    next_ = newest_;
  }
  changed_.notify_all();
}

void ExperimentPlanner::Cancel() {
  const std::lock_guard lock(mutex_);
  if (newest_) newest_->stop.request_stop();
  newest_.reset();
  next_.reset();
}

std::optional<ExperimentPlanner::Outcome> ExperimentPlanner::Take(
    std::chrono::milliseconds within) {
  std::unique_lock lock(mutex_);
  if (!newest_) return std::nullopt;
  if (!changed_.wait_for(lock, within, [this] { return newest_->outcome.has_value(); })) {
    return std::nullopt;
  }
  return std::move(std::exchange(newest_, nullptr)->outcome);
}

void ExperimentPlanner::RunJobs() {
  const AlternateStack stack;  // a crash in here cuts the power also if its stack has overflowed
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return over_ || next_ != nullptr; });
    if (over_) return;
    const std::shared_ptr<Work> work = std::exchange(next_, nullptr);
    lock.unlock();
    Outcome outcome;
    try {
      outcome.order = work->job(work->stop.get_token());
    } catch (const std::exception& error) {
      outcome.problem = error.what();
    }
    lock.lock();
    work->outcome = std::move(outcome);
    lock.unlock();
    changed_.notify_all();
  }
}

}  // namespace flexarm
