#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "tools/analysis/statement.h"
#include "tools/thesis/control_study.h"

// The sections of chapter 7, for Chapter7Statements.

namespace flexarm {

std::vector<Statement> LawStatements(const ControlStudy& study);         ///< 7.3
std::vector<Statement> SimulationStatements(const ControlStudy& study);  ///< 7.4
std::vector<Statement> ExperimentStatements(const ControlStudy& study);  ///< 7.5

/// ", the end of the grid" if it is one: the optimum may lie beyond.
template <std::size_t N>
std::string EndOfGrid(double value, const std::array<double, N>& grid) {
  return value == grid.front() || value == grid.back() ? " (end of the grid)" : "";
}

}  // namespace flexarm
