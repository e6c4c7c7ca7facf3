#pragma once

#include <vector>

#include "tools/analysis/statement.h"
#include "tools/thesis/control_study.h"

namespace flexarm {

/// Checks the statements of chapter 7 on the closed loop against the runs of ControlStudy and the
/// design's poles.
std::vector<Statement> Chapter7Statements(const ControlStudy& study);

}  // namespace flexarm
