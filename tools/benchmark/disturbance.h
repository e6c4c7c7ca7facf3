#pragma once

#include <string>
#include <vector>

namespace flexarm {

/// How a scenario differs from the nominal one of its table.
struct Disturbance {
  const char* name;
  const char* what;                      ///< description for the user
  const char* variant = "nominal";       ///< of the simulated rig alone, see PlantVariants
  std::vector<std::string> plant = {};   ///< --set of the simulated rig alone
  std::vector<std::string> config = {};  ///< --set of the rig and the controller
};

/// The disturbances of both the commands and the moves.
std::vector<Disturbance> CommonDisturbances();

}  // namespace flexarm
