#pragma once

#include <vector>

#include "config/config.h"
#include "controller/runlog/run_sink.h"
#include "tools/runs/conformance.h"

namespace flexarm {

/// The rules of the safety records of a run, and of its ticks against them: docs/safety.md,
/// "Requirements". The transitions are judged by transition_table.def, not by the product's code.
std::vector<ConformanceCheck> CheckSafety(const RunContents& run, const RigConfig& config);

}  // namespace flexarm
