#pragma once

#include <vector>

#include "tools/runs/conformance.h"

namespace flexarm {

/// The rules of the safety records of a run, and of its ticks against them: docs/safety.md,
/// "Requirements". The transitions are judged by transition_table.def, not by the product's code.
std::vector<ConformanceCheck> CheckSafety(const LoadedRun& run);

}  // namespace flexarm
