#pragma once

#include "config/config.h"
#include "config/problem_log.h"

namespace flexarm {

/// Rules between the structs of a config, which none of them can see alone. A rule is asked only if
/// nothing is wrong yet with the values that it compares.
void CheckCrossRules(const RigConfig& config, ProblemLog* log);

}  // namespace flexarm
