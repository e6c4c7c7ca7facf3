#pragma once

#include "controller/reference/timed_reference.h"
#include "controller/types/loop_grid.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// Writes the parts of an input that come from the reference: reference_now, reference_next, path
/// and reference_ended.
///
/// reference_now, at k Ts, lies between samples of the reference unless torques act at sampling
/// instants: linear interpolation.
/// @param sample  of the experiment, 0 in its first step
/// @param acts  sample at the instant at which the torque of this step acts: `sample`, and the
///        delay found where the law follows the reference
/// Real-time: safe.
void FollowReference(const TimedReference& reference, const LoopGrid& grid, int sample, int acts,
                     StepInput* input) noexcept;

}  // namespace flexarm
