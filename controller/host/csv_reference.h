#pragma once

#include <array>

#include "controller/law/design.h"
#include "controller/tasks/follow_reference.h"
#include "controller/tasks/planned_experiment.h"
#include "controller/types/control_config.h"
#include "controller/types/loop_grid.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// The reference of an experiment for the samples of a CSV file, which has none.
///
/// Tick 0 is the first sample of the run, as in a file that `flexarm export` writes.
class CsvReference {
 public:
  /// @param start_rad  hub angles of the first sample
  /// @throws RejectedError as PlannedExperiment
  CsvReference(const ControlConfig& config, const Design& design, const Experiment& experiment,
               const std::array<double, 2>& start_rad);

  CsvReference(const CsvReference&) = delete;
  CsvReference& operator=(const CsvReference&) = delete;

  /// The sample belongs to the experiment; the loop takes the torque away after its end.
  bool Covers(const StepInput& input) const { return input.tick < planned_.reference.periods(); }

  /// Writes what the control task of a run would have. A plan of the law `receding-horizon` is not
  /// made again: the law uses its closed form.
  /// @param before  of the step before, or of the first input
  void Give(const StepOutput& before, StepInput* input);

 private:
  LoopGrid grid_;
  PlannedExperiment planned_;
  TimedReference reference_;  // of planned_: not to be copied
};

}  // namespace flexarm
