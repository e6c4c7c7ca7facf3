#pragma once

#include <vector>

#include "config/config.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// Appendix B1: where the gauges are, and how well they measure the deflection (figure B.2).
std::vector<Statement> AppendixStatements(const RigConfig& config);

}  // namespace flexarm
