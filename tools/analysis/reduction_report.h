#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/analysis/linear_system_file.h"
#include "tools/analysis/reduction_grid.h"

namespace flexarm {

/// Power balancing and truncation by Gramians, for the arm at one nominal motion.
nlohmann::ordered_json ArmReductionJson(const ArmModel& model, const NominalMotion& motion,
                                        const ReductionOptions& options);

/// The same for any linear system. "power" is null, with the reason in "power_refused", if neither
/// condition of power balancing holds.
nlohmann::ordered_json SystemReductionJson(const LinearSystemFile& file,
                                           const ReductionOptions& options);

/// Extremes over the cells of a grid, and the number of cells with a rigid-body root that is not
/// zero.
nlohmann::ordered_json GridJson(const ReductionGrid& grid, const std::vector<ReductionCell>& cells);

/// Prints the same as text to standard output.
void PrintReduction(const nlohmann::ordered_json& json);

/// "mass", "length" or "tip", with an explanation.
const char* ToString(ModalScaling scaling);

}  // namespace flexarm
