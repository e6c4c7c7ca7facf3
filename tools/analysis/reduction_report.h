#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/analysis/linear_system_file.h"
#include "tools/analysis/reduction_grid.h"

namespace flexarm {

/// What `analyze reduce` is asked about one nominal motion, or about any system.
struct ReductionOptions {
  ModalScaling scaling = ModalScaling::kMass;
  double rigid_below_rad2_s2 = PowerOptions{}.rigid_below_rad2_s2;
  double margin_per_s = 1e-2;  ///< a stable mode decays faster; the others are kept whole
};

/// Power balancing and truncation by Gramians of the arm at one nominal motion.
nlohmann::ordered_json ArmReductionJson(const ArmModel& model, const NominalMotion& motion,
                                        const ReductionOptions& options);

/// The same of any linear system. "power" is null, with the reason in "power_refused", if neither
/// condition of power balancing holds.
nlohmann::ordered_json SystemReductionJson(const LinearSystemFile& file,
                                           const ReductionOptions& options);

/// Extremes over the cells of a grid, and how many had a rigid-body root that was not zero.
nlohmann::ordered_json GridJson(const ReductionGrid& grid, const std::vector<ReductionCell>& cells);

/// The same for people, on standard output.
void PrintReduction(const nlohmann::ordered_json& json);

/// "mass", "length" or "tip", and what it means.
const char* Name(ModalScaling scaling);

}  // namespace flexarm
