#pragma once

#include <string>
#include <vector>

namespace flexarm {

/// How a situation differs from the nominal one of its table.
struct Disturbance {
  const char* name;
  const char* what;                      ///< in a user's words
  const char* variant = "nominal";       ///< of the simulated rig alone, see PlantVariants
  std::vector<std::string> plant = {};   ///< --set of the simulated rig alone
  std::vector<std::string> config = {};  ///< --set of the rig and the controller
};

/// Those that every law meets, whatever it follows.
std::vector<Disturbance> CommonDisturbances();

}  // namespace flexarm
