#pragma once

#include <string>

#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// What distinguishes an arm from the thesis's, whose statements, figures and published numbers
/// hold for that arm alone: "its link 1 is 0.4 m long, the thesis's 0.8 m"; "" for the thesis's.
///
/// Compares what cannot change without another arm being built: the links' lengths and cross
/// sections and the mass at the elbow (Table 2), to 0.1 %. Material, payload, joints, sensors and
/// limits may differ: they are varied in the thesis or not given there.
std::string DiffersFromThesisArm(const ArmParameters& arm);

inline bool IsThesisArm(const ArmParameters& arm) { return DiffersFromThesisArm(arm).empty(); }

}  // namespace flexarm
