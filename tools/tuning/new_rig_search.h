#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/new_rig/arm_description.h"
#include "config/new_rig/rig_text.h"

namespace flexarm {

/// A config for an arm, and how it was found.
struct NewRigResult {
  bool passed;                            ///< sound, and the simulated moves end on their targets
  std::string text;                       ///< of the config
  double design_score;                    ///< of its margins, without unit: DesignScore
  std::vector<std::string> notes;         ///< what was tuned, slowed down, or is in the way
  double largest_error_mm, permitted_mm;  ///< of the simulated moves
  /// If it did not pass: the smallest change of the description with which it would.
  std::optional<std::string> proposal;
};

/// Derives, designs, tunes if a check fails, simulates moves to random places with the least, the
/// usual and the greatest payload, and lowers limits.plan_fraction until they end well, then
/// controller.payload.fast_fraction until fast moves do, where the payload is estimated.
/// @param progress  called with what is being done
NewRigResult FindRig(const ArmDescription& arm,
                     const std::function<void(const std::string&)>& progress);

}  // namespace flexarm
