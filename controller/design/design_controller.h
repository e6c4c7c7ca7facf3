#pragma once

#include "controller/design/command_generator.h"
#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// Designs nominal model, reference model, gains and filter for a rig. Takes tens of milliseconds.
/// @throws std::runtime_error naming the equation that has no solution
Design DesignController(const ControlConfig& config);

/// The tracking problem of a design's command generator, in the coordinates of its solution.
TrackingProblem TrackingProblemOf(const ControlConfig& config, const Design& design);

}  // namespace flexarm
