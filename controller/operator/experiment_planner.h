#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "controller/operator/experiment_loader.h"

namespace flexarm {

/// A thread that reads and plans experiments, one at a time: 1,700 moves take seconds, in which
/// the operator task goes on. Ordinary scheduling. Thread of the calls: operator.
class ExperimentPlanner {
 public:
  /// Makes a plan. Ends soon after a stop is requested, by an exception.
  using Job = std::function<ExperimentLoader::Order(const std::stop_token&)>;

  /// What became of a job: exactly one of the two.
  struct Outcome {
    std::optional<ExperimentLoader::Order> order{};
    std::string problem{};  ///< why there is no plan
  };

  ExperimentPlanner();
  /// Cancels the job, and waits until its thread has ended.
  ~ExperimentPlanner();
  ExperimentPlanner(const ExperimentPlanner&) = delete;
  ExperimentPlanner& operator=(const ExperimentPlanner&) = delete;

  /// Begins a job, after the one before has ended; that one is cancelled if it has not.
  void Begin(Job job);

  /// The outcome of the newest job is dropped.
  void Cancel();

  /// The outcome of the newest job, once. @param within  how long to wait for it
  std::optional<Outcome> Take(std::chrono::milliseconds within);

 private:
  struct Work {
    Job job;
    std::stop_source stop{};
    std::optional<Outcome> outcome{};
  };

  void RunJobs();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<Work> newest_;  // begun and not taken or cancelled; nullptr: none
  std::shared_ptr<Work> next_;    // not yet begun by the thread
  bool over_ = false;
  std::thread thread_;
};

}  // namespace flexarm
