#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/sweep/random_moves.h"

namespace flexarm {

/// One scenario of the benchmark: a command, a payload, and the changes of plant and loop.
struct Scenario {
  std::string name;
  std::string what;  ///< description for the user
  Experiment experiment;
  double payload_kg;                ///< of the simulated rig
  std::string variant;              ///< of the simulated rig alone, see PlantVariants
  std::vector<std::string> plant;   ///< --set of the simulated rig alone
  std::vector<std::string> config;  ///< --set of the rig and the controller
  bool tuned_on;                    ///< parameters of some law were chosen on it
  /// If set, the run's seed determines random moves and a payload by this recipe
  /// (MakeRandomMoves), in place of `experiment` and `payload_kg`.
  std::optional<MoveRecipe> random = std::nullopt;
  bool fast = false;  ///< with `random`: MakeFastMoves
};

}  // namespace flexarm
