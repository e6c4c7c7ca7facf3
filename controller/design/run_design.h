#pragma once

#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// The design to run with: the one in `controller.gains`, verified by CheckGains, or a new one.
/// @throws RejectedError if there is none, if a number of the file is not that of the config's
///   design, or if one of its checks failed
Design DesignFor(const ControlConfig& config);

}  // namespace flexarm
