#pragma once

#include <vector>

#include "tools/analysis/control_study.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// What chapter 7 says of the closed loop, against the loops of the study and the design's poles.
std::vector<Statement> Chapter7Statements(const ControlStudy& study);

}  // namespace flexarm
