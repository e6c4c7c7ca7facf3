#pragma once

#include <optional>
#include <string>
#include <vector>

#include "config/config.h"

namespace flexarm {

/// One situation of the benchmark: a command, a load, and what the plant and the loop are then.
struct Scenario {
  std::string name;
  std::string what;  ///< in a user's words
  Experiment experiment;
  double payload_kg;                ///< that the simulated rig carries
  std::string variant;              ///< of the simulated rig alone, see PlantVariants
  std::vector<std::string> plant;   ///< --set of the simulated rig alone
  std::vector<std::string> config;  ///< --set of the rig and the controller
  bool tuned_on;                    ///< parameters of some law were chosen on it
  /// In place of `experiment` and `payload_kg`: moves and a payload up to this that the run's seed
  /// draws (MakeRandomMoves).
  std::optional<double> random_up_to_kg = std::nullopt;
};

}  // namespace flexarm
