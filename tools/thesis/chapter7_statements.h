#pragma once

#include <vector>

#include "tools/analysis/statement.h"
#include "tools/thesis/control_study.h"

namespace flexarm {

/// What chapter 7 says of the closed loop, against the loops of ControlStudy and the design's
/// poles.
std::vector<Statement> Chapter7Statements(const ControlStudy& study);

}  // namespace flexarm
