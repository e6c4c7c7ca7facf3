#pragma once

#include "controller/types/experiment.h"

namespace flexarm {

/// The rows of an experiment at a share of their speed: all times are longer, on the grid of the
/// loop. Its text stays, as it states the speed; `speed` is 1. Not real-time safe.
/// @param experiment  with the durations of its moves
/// @param speed       above 0 to 1
/// @throws RejectedError for a row that is a signal in time: a chirp, a PRBS or a trajectory
Experiment Slowed(Experiment experiment, double speed, double period_s);

}  // namespace flexarm
