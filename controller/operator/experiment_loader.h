#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "controller/runlog/event_queue.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// Plans experiments, hands them to the loop, and keeps them until the loop has released them.
///
/// Not real-time safe: planning takes milliseconds and allocates. Thread: operator.
class ExperimentLoader {
 public:
  /// All pointers outlive the loader.
  /// @param events  to the recorder: one "experiment" for every experiment that is loaded
  ExperimentLoader(LoopStack* stack, EventQueue* events, const Design* design, const LoopGrid& grid,
                   const MotionLimits& limits)
      : stack_(stack), events_(events), design_(design), grid_(grid), limits_(limits) {}

  /// Plans `experiment` from these hub angles, rad, and loads it for the next run.
  /// @throws RejectedError if it is impossible, or has simulated events and the rig is real
  void Plan(std::int64_t now_ns, const Experiment& experiment,
            const std::array<double, 2>& start_rad);

  /// Loads an experiment that is planned already, for the next run.
  /// @param text  for the log: the experiment's file, or the command that it comes from
  void Load(std::int64_t now_ns, std::unique_ptr<PlannedExperiment> planned,
            const std::string& name, const std::string& text);

  /// Frees the experiments that the loop no longer uses. Once a period.
  void FreeReleased();

  /// Name of the newest experiment; empty: none has been loaded.
  const std::string& name() const { return name_; }
  /// How many experiments are in memory.
  std::size_t size() const { return loaded_.size(); }

 private:
  struct Loaded {
    std::uint32_t number;
    std::unique_ptr<PlannedExperiment> experiment;
  };

  LoopStack* stack_;
  EventQueue* events_;
  const Design* design_;
  LoopGrid grid_;
  MotionLimits limits_;
  std::deque<Loaded> loaded_;  // in order of number
  std::uint32_t number_ = 0;   // of the newest
  std::string name_;
};

}  // namespace flexarm
