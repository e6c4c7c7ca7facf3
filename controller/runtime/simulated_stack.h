#pragma once

#include <cstdint>

#include "controller/law/control_step.h"
#include "controller/law/design.h"
#include "controller/runtime/control_task.h"
#include "controller/runtime/plant_task.h"
#include "controller/runtime/safety_task.h"
#include "controller/runtime/simulated_lines.h"
#include "controller/runtime/stack_config.h"

namespace flexarm {

/// The three real-time tasks of the daemon on the simulated rig, and the channels between them.
///
/// Either executor runs them. The outside gets the other ends: requests and plans in, permits,
/// answers and records out. Construction allocates; running does not.
class SimulatedStack {
 public:
  /// @param payload_kg  that the plant carries; the design keeps the config's
  SimulatedStack(const StackConfig& config, const Design& design, double payload_kg);
  SimulatedStack(const SimulatedStack&) = delete;
  SimulatedStack& operator=(const SimulatedStack&) = delete;

  SafetyTask& safety() { return safety_; }
  ControlTask& control() { return control_; }
  PlantTask& plant() { return plant_; }

  // Operator's ends: one thread.
  SpscQueue<OperatorRequest>& requests() { return requests_; }
  SpscQueue<RequestAnswer>& answers() { return answers_; }
  SpscQueue<LinePress>& presses() { return presses_; }
  /// The experiment of the next run; see PlannedRun for how long it must live.
  void Plan(const PlannedRun& plan) noexcept;
  /// Plans with a lower number than this are no longer used.
  std::uint32_t released_plans() const noexcept;
  PermitChannel& operator_permits() { return operator_permits_; }
  LatestValue<TickRecord>& telemetry() { return telemetry_; }

  // Recorder's ends: one thread.
  SpscQueue<TickRecord>& tick_records() { return tick_records_; }
  SpscQueue<SafetyRecord>& safety_records() { return safety_records_; }

 private:
  FrameChannel frames_{FrameHistory(kNoFrame)};
  CommandChannel commands_{CommandHistory(kNoCommand)};
  PermitChannel control_permits_{PermitHistory(kNoPermit)};
  PermitChannel plant_permits_{PermitHistory(kNoPermit)};
  PermitChannel operator_permits_{PermitHistory(kNoPermit)};
  OutputChannel outputs_;
  LevelChannel levels_;
  ControlReportChannel control_reports_{ControlReportHistory(kNoControlReport)};
  DriveReportChannel drive_reports_{DriveReportHistory(kNoDriveReport)};
  PlanChannel control_plans_{PlannedRun{}};
  PlanChannel plant_plans_{PlannedRun{}};
  LatestValue<TickRecord> telemetry_{TickRecord{}};
  SpscQueue<OperatorRequest> requests_;
  SpscQueue<RequestAnswer> answers_;
  SpscQueue<LinePress> presses_;
  SpscQueue<TickRecord> tick_records_;
  SpscQueue<SafetyRecord> safety_records_;
  SimulatedLines lines_;
  ControlStep step_;
  SafetyTask safety_;
  ControlTask control_;
  PlantTask plant_;
};

}  // namespace flexarm
