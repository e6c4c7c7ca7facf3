#pragma once

#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// The design to run with: the one in `controller.gains`, or a new one.
/// @throws Refused when there is none, or a check of it failed
Design DesignFor(const ControlConfig& config);

}  // namespace flexarm
