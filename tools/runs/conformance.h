#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/runs/run_summary.h"

namespace flexarm {

/// One safety or consistency rule, and whether the run obeys it.
struct ConformanceCheck {
  std::string name;  ///< "slew-limit"
  bool passed;
  std::string detail;                    ///< the first violation; empty if there is none
  std::optional<double> time_s{};        ///< of the violation, in the time of the log
  std::optional<std::int64_t> record{};  ///< number of its row in table `safety`
};

/// Checks a run log: no missing tick, increasing time, the limits of its own config, no torque in
/// states that do not allow it, the rules of its safety records (safety_conformance.h).
std::vector<ConformanceCheck> CheckConformance(const LoadedRun& run);

}  // namespace flexarm
