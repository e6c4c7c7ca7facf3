#pragma once

#include <array>
#include <vector>

#include "controller/types/rig_config.h"
#include "model/problem.h"

namespace flexarm {

// The violated rules of every section by itself, one list a struct, in the order of a config file.

/// Of the rig's name and the arm.
std::vector<std::vector<Problem>> RulesOfArm(const RigConfig& config);

/// Of all other sections.
/// @param link_length_m  of link 1, 2, which bound the gauges' positions; NaN: not known
std::vector<std::vector<Problem>> RulesOfRest(const RigConfig& config,
                                              const std::array<double, 2>& link_length_m);

}  // namespace flexarm
