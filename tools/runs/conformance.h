#pragma once

#include <string>
#include <vector>

#include "tools/runs/run_summary.h"

namespace flexarm {

/// One safety or consistency rule, and whether the run obeys it.
struct ConformanceCheck {
  std::string name;  ///< "slew-limit"
  bool passed;
  std::string detail;  ///< the first violation; empty if there is none
};

/// Checks a run log: no missing tick, increasing time, the limits of its own config, no torque in
/// states that do not allow it, safety transitions as the state machine prescribes.
std::vector<ConformanceCheck> CheckConformance(const LoadedRun& run);

}  // namespace flexarm
