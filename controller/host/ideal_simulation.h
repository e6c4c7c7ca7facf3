#pragma once

#include "controller/host/simulation.h"
#include "controller/law/design.h"
#include "controller/tasks/planned_experiment.h"

namespace flexarm {

/// One run with known state and without delay, as the thesis's simulations (7.5): at every sample
/// the plant is held, ControlStep::Step gets its true state, and the torque acts at once. The arm,
/// its motors' lag, the step and the law are those of any run; estimator, delay, torque gate and
/// safety tasks take no part, and frames are never lost. A fault that the step finds ends the run.
///
/// The log has no safety records; its replay takes the state from the recorded estimate, which is
/// the plant's.
/// @param contents  gets the ticks
/// @returns the fault that ended the run
/// @throws RejectedError  the experiment has a row [[sim_event]]
TripCause RunIdeal(const SimulationRequest& request, const Design& design,
                   const PlannedExperiment& planned, double payload_kg, RunContents* contents);

}  // namespace flexarm
