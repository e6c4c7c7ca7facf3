#pragma once

#include "config/config.h"
#include "config/problem_log.h"

namespace flexarm {

/// Checks the rules between several structs of a config. A rule is checked only if the values that
/// it compares have no other problem.
void CheckCrossRules(const RigConfig& config, ProblemLog* log);

}  // namespace flexarm
