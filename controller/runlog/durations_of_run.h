#pragma once

#include <span>

#include "controller/types/experiment.h"
#include "controller/types/records.h"

namespace flexarm {

/// The experiment with the durations that the run has chosen for its moves `duration = "shortest"`,
/// found in the recorded path; a move that the run did not finish keeps the longest.
/// @param ticks  of the run; the first interval in state Running counts
Experiment WithDurationsOfRun(const Experiment& experiment, std::span<const TickRecord> ticks,
                              double period_s);

}  // namespace flexarm
