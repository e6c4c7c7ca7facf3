#pragma once

#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// The design to run with: the one in `controller.gains`, or a new one.
/// @throws RejectedError if there is none, or if one of its checks failed
Design DesignFor(const ControlConfig& config);

}  // namespace flexarm
