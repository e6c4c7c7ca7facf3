#pragma once

#include <vector>

#include "controller/host/host_checks.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// Checks this machine, with the permissions and limits of this process: whether it may run any
/// real rig. Not real-time safe; takes milliseconds.
std::vector<HostCheck> CheckHost();

/// The same, and what the buses of `config` need.
std::vector<HostCheck> CheckHost(const RigConfig& config);

}  // namespace flexarm
