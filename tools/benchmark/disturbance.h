#pragma once

#include <string>
#include <vector>

#include "config/config.h"

namespace flexarm {

/// How a scenario differs from the nominal one of its table.
struct Disturbance {
  std::string name;
  std::string what;                      ///< description for the user
  std::string variant = "nominal";       ///< of the simulated rig alone, see PlantVariants
  std::vector<std::string> plant = {};   ///< --set of the simulated rig alone
  std::vector<std::string> config = {};  ///< --set of the rig and the controller
};

/// The disturbances of both the commands and the moves: times in periods of the rig, noise as a
/// multiple of its own.
std::vector<Disturbance> CommonDisturbances(const RigConfig& config);

}  // namespace flexarm
