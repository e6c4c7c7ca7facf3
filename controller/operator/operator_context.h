#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "controller/latch/trip_latch.h"
#include "controller/operator/arm_verdict.h"
#include "controller/operator/journal_report.h"
#include "controller/operator/run_command.h"
#include "controller/runlog/event_queue.h"
#include "controller/runlog/run_files.h"
#include "controller/runlog/trip_reports.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// What the operator task needs of its daemon. What is pointed to outlives the task.
struct OperatorContext {
  LoopStack* stack;
  TripLatch* latch;           ///< open before the first period
  EventQueue* events;         ///< to the recorder
  RunFiles* files = nullptr;  ///< of the logs; null: runs need none
  const Design* design;
  const RigConfig* config;
  LoopGrid grid;
  double delay_margin_s;  ///< of the design (controller/design/robustness_analysis.h)
  MotionLimits limits;
  MotionLimits reduced_limits{};  ///< while the limits are reduced
  ArmChecks arm_checks;
  std::string socket;                    ///< path; empty: no socket
  std::optional<Experiment> unattended;  ///< run once without a person
  /// Reads an experiment that a client sent. Throws std::exception with the reasons. Called by a
  /// thread of its own.
  std::function<Experiment(const std::string& text, const std::string& name)> parse_experiment;
  JudgeExperiment judge_experiment = {};  ///< by the same thread; empty: nothing is judged
  JournalReport report;
  nlohmann::json identity =
      nlohmann::json::object();  ///< keys of the status: which rig and program
  /// Makes "threads" of the status: lateness and run time of every task.
  std::function<nlohmann::json()> thread_status;
  /// Told of every sample that this task reads; never waits. Empty: they go nowhere.
  std::function<void(const TickRecord&)> take_tick = {};
  /// Makes "telemetry" of the status. Empty: null.
  std::function<nlohmann::json()> telemetry_status = {};
  /// Makes "health" of the status. Empty: null.
  std::function<nlohmann::json()> health_status = {};
  /// Called once a period while safety and control are alive: the service manager's watchdog.
  std::function<void(std::int64_t now_ns, const std::string& status)> alive;
  /// The newest report of a trip (TripReports::newest); empty: reports are not written.
  std::function<TripReport()> newest_trip_report = {};
  /// RunCommand::Targets::plan_wait.
  std::chrono::milliseconds plan_wait{0};
};

}  // namespace flexarm
