#pragma once

#include <cstdint>
#include <vector>

#include "controller/types/rig_config.h"
#include "controller/types/trip_cause.h"
#include "tools/torture/fault.h"

namespace flexarm {

/// The causes that may name a fault: those of its own, and the limits that an arm exceeds which a
/// wrong reading or torque leads astray.
TripCauses NamesOf(const Fault& fault);

/// Whether the fault is abrupt, so that it must be named as soon as it can be seen: nothing comes,
/// no number, garbage, a wrong scale, stuck.
bool IsAbrupt(FaultKind kind) noexcept;

/// Whether the loop may go on without the reading: gauges of which enough are left.
bool IsBridged(const Fault& fault) noexcept;

/// Whether no other encoder checks this counter: the hub of a joint whose rotor has none.
bool IsAlone(const RigConfig& config, int counter) noexcept;

/// The longest time from the instant from which a fault can be seen until its cause latches;
/// INT64_MAX: it need not be named, because nothing measures it or the arm is safe with it.
/// docs/torture.md says why for each.
std::int64_t NamedWithinNs(const RigConfig& config, const Fault& fault) noexcept;

/// Whether the faults leave nothing that measures where the hub of a joint (0, 1) is: a limit
/// switch of the joint is stuck, and its encoders deceive in agreement with each other.
bool HideAngle(const RigConfig& config, const std::vector<Fault>& faults, int joint) noexcept;

}  // namespace flexarm
