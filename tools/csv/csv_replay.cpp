#include "tools/csv/csv_replay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include "controller/commissioning/calibration_file.h"
#include "controller/design/run_design.h"
#include "controller/files/input_error.h"
#include "controller/host/csv_reference.h"
#include "controller/runlog/csv_import.h"
#include "controller/step/control_step.h"
#include "controller/types/rejected_error.h"
#include "tools/csv/strain_scale_check.h"

namespace flexarm {
namespace {

Calibration CalibrationOf(const CsvReplayTask& task) {
  if (task.calibration.empty()) return {};
  const auto read = ReadCalibration(task.calibration, task.config.sensors);
  if (!read) throw InputError(task.calibration.string() + ": there is no such file");
  return *read;
}

// The file has no instants of the torques: the loop's grid has those that were planned.
CsvRun RunOf(const CsvReplayTask& task, const Calibration& calibration) {
  const RigConfig& config = task.config;
  CsvRun run = ReadAnyCsv(task.source, config.csv ? &*config.csv : nullptr, config.sensors,
                          config.loop.period_s());
  for (StepInput& input : run.input) {
    input.calibration = calibration;
    input.acted_late_ns = input.acts_late_ns = LoopGrid(config.loop).late_ns();
  }
  return run;
}

std::unique_ptr<CsvReference> ReferenceOf(const CsvReplayTask& task, const Design& design,
                                          const StepInput& first) {
  if (task.experiment.empty()) return nullptr;
  const StepOutput at_start = ControlStep(task.config, design).Step(first);
  try {
    return std::make_unique<CsvReference>(task.config, design, LoadExperiment(task.experiment),
                                          std::array{at_start.angle_rad[0], at_start.angle_rad[1]});
  } catch (const RejectedError& error) {
    throw RejectedError(task.experiment.string() + ": " + error.what());
  }
}

// The torques that the loop asked for, as the file would have them: each row has the mean of what
// acted since the row before. What the torque gate changed is a difference.
class AppliedTorques {
 public:
  explicit AppliedTorques(const LoopGrid& grid)
      : whole_(FloorDivide(grid.late_ns(), grid.period_ns)),
        part_(static_cast<double>(grid.late_ns() - whole_ * grid.period_ns) /
              static_cast<double>(grid.period_ns)) {}

  void Asked(std::int64_t tick, const std::array<double, 2>& torque_nm) {
    asked_[tick] = torque_nm;
  }

  /// Updates the largest differences, if all that acted before this row is known.
  void Compare(const StepInput& row, std::array<double, 2>* largest_nm) const {
    // The torque of step i acts from (i + 1 + whole + part) Ts on, for a period.
    const auto newest = asked_.find(row.tick - 2 - whole_);
    const auto before = part_ > 0.0 ? asked_.find(row.tick - 3 - whole_) : newest;
    if (newest == asked_.end() || before == asked_.end()) return;
    for (std::size_t i = 0; i < 2; ++i) {
      const double acted_nm = (1.0 - part_) * newest->second[i] + part_ * before->second[i];
      const double difference_nm = std::abs(acted_nm - row.applied_torque_nm[i]);
      (*largest_nm)[i] = std::max((*largest_nm)[i], difference_nm);
    }
  }

 private:
  static std::int64_t FloorDivide(std::int64_t a, std::int64_t b) {
    return a / b - (a % b < 0 ? 1 : 0);
  }

  std::int64_t whole_;  // late_ns in periods: whole ones, and the part of one
  double part_;
  std::map<std::int64_t, std::array<double, 2>> asked_;  // by tick
};

}  // namespace

CsvReplayResult ReplayCsv(const CsvReplayTask& task) {
  const Calibration calibration = CalibrationOf(task);
  const CsvRun run = RunOf(task, calibration);
  const std::vector<StepInput>& inputs = run.input;
  const Design design = DesignFor(task.config);
  const std::unique_ptr<CsvReference> reference = ReferenceOf(task, design, inputs.front());
  AppliedTorques torques{LoopGrid(task.config.loop)};
  ControlStep step(task.config, design);
  StepOutput before{};
  Replay replay(
      [&](const StepInput& input) {
        before = step.Step(input);
        torques.Asked(input.tick, before.torque_nm);
        return before;
      },
      true);
  std::int64_t left_out = 0;
  std::array<double, 2> largest_nm{};
  for (const StepInput& input : inputs) {
    if (reference && !reference->Covers(input)) {  // here the loop takes the torque away
      ++left_out;
      continue;
    }
    torques.Compare(input, &largest_nm);
    TickRecord record{};
    record.input = input;
    if (reference) reference->Give(before, &record.input);
    replay.Tick(record);
  }
  CsvReplayResult replayed{.result = replay.Result(),
                           .left_out = {},
                           .facts = run.facts,
                           .scales = CheckStrainScales(task.config, calibration, run)};
  replayed.result.max_torque_difference_nm = largest_nm;
  replayed.result.first_different_tick.reset();  // there are no recorded outputs
  if (reference) replayed.left_out = left_out;
  return replayed;
}

}  // namespace flexarm
