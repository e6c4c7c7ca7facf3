#pragma once

#include <vector>

#include "config/config.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// Section 7.2's control features of the arm and 7.3.3's explanation of one of them: zeros, poles
/// at the origin, the condition for perfect model following; the cost of a larger nominal model;
/// torsion of the links, which no model has.
std::vector<Statement> ControlFeatureStatements(const RigConfig& config);

}  // namespace flexarm
