#pragma once

#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// Designs the controller of `config` again and compares every number of `read`, the design of a
/// gains file, with it: a file that was damaged or edited must not control the arm. Takes a quarter
/// of a second.
///
/// A number may differ by 1e-6 of itself plus 1e-9 of the largest of its matrix, as between
/// processors. The checks of `read` become those computed here, with their waivers. Of the
/// robustness analysis, which JudgeDesign computes, only the names are looked at.
/// @throws RejectedError naming the first number that differs, with both values
void CheckGains(const ControlConfig& config, Design* read);

}  // namespace flexarm
