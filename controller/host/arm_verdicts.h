#pragma once

#include <vector>

#include "controller/design/design_verdict.h"
#include "controller/host/host_checks.h"
#include "controller/operator/arm_verdict.h"

// The checks before arming, in the form in which the operator task judges them. Pure functions.

namespace flexarm {

/// @param realtime  false: the daemon runs with --without-realtime, which no machine makes good
ArmVerdict HostVerdictOf(const std::vector<HostCheck>& checks, bool realtime);

ArmVerdict DesignVerdictOf(const DesignVerdict& verdict);

}  // namespace flexarm
