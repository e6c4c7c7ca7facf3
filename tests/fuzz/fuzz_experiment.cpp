#include "config/config.h"
#include "controller/tasks/planned_experiment.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/support/loop_time.h"

namespace flexarm {

// As the daemon takes one that a client sends: read, then planned.
void FuzzExperiment(FuzzBytes input) {
  static const Design& design = ShippedDesign();
  try {
    const Experiment experiment = ParseExperiment(TextOf(input), "input");
    const PlannedExperiment planned(experiment, design, kPeriod_s, {0.0, 0.0}, ShippedLimits());
  } catch (const ConfigError&) {
  } catch (const RejectedError&) {
  }
}

}  // namespace flexarm
