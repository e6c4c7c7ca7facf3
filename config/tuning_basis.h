#pragma once

#include "config/derivation/arm_scales.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// What the derived values of a config depend on, as the config has it.
TuningBasis TuningBasisOf(const ControlConfig& config);

}  // namespace flexarm
