#pragma once

#include <string>
#include <vector>

#include "config/config.h"

namespace flexarm {

/// Plants by name that differ from the plant that the controller is designed for. "nominal" does
/// not differ.
struct PlantVariant {
  const char* name;
  const char* what;
};

const std::vector<PlantVariant>& PlantVariants();

/// The overrides that turn the config's plant into the variant, in the form of --set.
/// @throws InputError  there is no such variant
std::vector<std::string> VariantOverrides(const RigConfig& config, const std::string& name);

/// The config of the simulated rig alone: `config` with `overrides` in the sections that describe
/// a plant: arm, link1, link2, joint1, joint2, sensors, sim.
/// @throws InputError  a key of another section; ConfigError
RigConfig PlantWith(const RigConfig& config, const std::vector<std::string>& overrides);

}  // namespace flexarm
