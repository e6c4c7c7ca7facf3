#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "controller/law/design.h"
#include "controller/step/control_step.h"
#include "controller/tasks/bus_health.h"
#include "controller/tasks/control_task.h"
#include "controller/tasks/planner_task.h"
#include "controller/tasks/safety_task.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// Level of a simulated switch, set by the operator: `flexarm sim LINE LEVEL`.
struct LinePress {
  Line line;
  int level;
};

/// Interface of a backend to the safety and control tasks. All of it outlives the stack.
struct LoopWiring {
  SafetyLines* lines;
  std::vector<FrameChannel*> frames;        ///< one a bus, with its part of the readings
  std::vector<CommandChannel*> commands;    ///< one a drive bus
  std::vector<PermitChannel*> permits;      ///< one a drive bus
  std::vector<DriveReportChannel*> drives;  ///< one a bus
  std::vector<Wakeup*> wakeups{};           ///< of the tasks that switch drives off
  /// False: the arm is simulated in process. Late threads are counted then, but do not trip.
  bool metal_moves = true;
};

/// The safety and control tasks of the daemon for any backend, and their queues and channels to the
/// operator and recorder: requests in, permits, answers and records out.
/// Construction allocates; running does not.
class LoopStack {
 public:
  LoopStack(const RigConfig& config, const Design& design, const LoopWiring& wiring);
  virtual ~LoopStack() = default;
  LoopStack(const LoopStack&) = delete;
  LoopStack& operator=(const LoopStack&) = delete;

  /// All tasks, for an executor: safety, control, those of the backend, the planner.
  std::vector<Task*> tasks();
  SafetyTask& safety() { return safety_; }
  /// Null: the law does not plan ahead.
  const Task* planner() const noexcept { return planner_.get(); }
  /// Tasks of the backend, in order of priority.
  virtual std::vector<Task*> drive_tasks() = 0;
  /// The task whose timing is logged: one activation a sample.
  virtual Task& control() { return control_; }

  /// Instant 0 of the loop in CLOCK_MONOTONIC, the clock of the devices' time stamps. Before any
  /// task runs.
  virtual void SetEpoch(std::int64_t /*epoch_ns*/) noexcept {}

  /// The arm starts Tripped, by a trip from before the start. Before any task runs.
  void StartTripped(TripCause cause, const Evidence& evidence) noexcept {
    safety_.StartTripped(cause, evidence);
  }

  // For the operator: one thread.
  /// For arm, run and reset, and for planned requests. A request of the operator is pushed only
  /// when the one before is answered (RequestTracker), so the queue never fills.
  SpscQueue<OperatorRequest>& requests() { return requests_; }
  /// Requests that never wait behind another.
  LatchedRequest& stop() { return stop_; }
  LatchedRequest& disarm() { return disarm_; }
  SpscQueue<RequestAnswer>& answers() { return answers_; }
  PermitChannel& operator_permits() { return operator_permits_; }
  /// Every step, for status and commissioning.
  SpscQueue<TickRecord>& operator_ticks() { return operator_ticks_; }
  /// The control task applies it as soon as no torque is allowed.
  void Calibrate(const Calibration& calibration) noexcept { calibrations_.Publish(calibration); }
  /// Experiments of runs with a lower number than this are no longer used.
  virtual std::uint32_t released_experiments() const noexcept { return control_.released(); }
  /// How late the threads of the loop were.
  const TimingCounts& timing() noexcept { return timing_.Read(); }
  /// The causes that would trip now, with their values.
  const PresentCauses& present_causes() noexcept { return present_.Read(); }
  /// Whether late threads trip.
  bool late_threads_trip() const noexcept { return late_threads_trip_; }
  /// Health of the buses. Empty: this backend has none.
  virtual std::vector<BusHealth> buses() { return {}; }
  /// Of all counters, BusDevice::count_epochs with what the buses' tasks have found.
  virtual CountEpochs count_epochs() { return {}; }
  /// Bus, device, node and error behind a trip; empty: the trip is not of a bus.
  virtual std::string BusText(TripCause /*cause*/, const Evidence& /*evidence*/) const {
    return {};
  }
  /// Whether [[sim_event]] rows are possible. A hardware rig rejects an experiment with such rows.
  virtual bool simulated() const noexcept { return false; }
  /// False: this backend has no simulated switches.
  virtual bool Press(const LinePress& /*press*/) noexcept { return false; }
  /// True state of the simulated arm at each sample, for the log; null: a hardware rig.
  virtual SpscQueue<TruthRecord>* truth_records() noexcept { return nullptr; }

  /// Any thread, at once: the safety task stops the arm, disarms it and starts nothing more.
  void RequestShutdown() noexcept { shutting_down_.store(true, std::memory_order_release); }

  /// Any thread: limits from the next arming on; the safety task takes no others while the relay is
  /// closed.
  void SetReduced(bool reduced) noexcept { reduced_.store(reduced, std::memory_order_release); }
  bool reduced() const noexcept { return reduced_.load(std::memory_order_acquire); }

  /// Relay and charge pump off for good, for a process that is about to end: SafetyLines::HoldOff.
  /// Any thread, also in a signal handler.
  void HoldLinesOff() noexcept { lines_->HoldOff(); }

  // For the recorder: one thread. Any thread may ask how many records were dropped.
  SpscQueue<TickRecord>& tick_records() { return tick_records_; }
  SpscQueue<SafetyRecord>& safety_records() { return safety_records_; }

 private:
  PermitChannel control_permits_{PermitHistory(kNoPermit)};
  PermitChannel operator_permits_{PermitHistory(kNoPermit)};
  ControlReportChannel control_reports_{ControlReportHistory(kNoControlReport)};
  CalibrationChannel calibrations_{Calibration{}};
  TimingChannel timing_{TimingCounts{}};
  PresentCausesChannel present_{PresentCauses{}};
  SafetyLines* lines_;
  bool late_threads_trip_;
  SpscQueue<OperatorRequest> requests_;
  LatchedRequest stop_, disarm_;
  std::atomic<bool> shutting_down_{false};
  std::atomic<bool> reduced_;
  SpscQueue<RequestAnswer> answers_;
  SpscQueue<TickRecord> tick_records_;
  SpscQueue<TickRecord> operator_ticks_;
  SpscQueue<SafetyRecord> safety_records_;
  ControlStep step_;
  std::unique_ptr<PlannerTask> planner_;    // with receding-horizon only, else nullptr
  std::unique_ptr<PlanFollower> follower_;  // the same
  SafetyTask safety_;
  ControlTask control_;
};

}  // namespace flexarm
