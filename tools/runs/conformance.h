#pragma once

#include <string>
#include <vector>

#include "tools/runs/run_summary.h"

namespace flexarm {

/// One rule that every run obeys, and whether this one did.
struct ConformanceCheck {
  std::string name;  ///< "slew-limit"
  bool passed;
  std::string detail;  ///< the first place where it was broken; empty if it was not
};

/// Judges what a log says about its run: no gap, time runs forward, the limits of its own config
/// obeyed, no torque where none is allowed, the safety machine's word kept.
std::vector<ConformanceCheck> CheckConformance(const LoadedRun& run);

}  // namespace flexarm
