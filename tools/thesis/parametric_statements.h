#pragma once

#include <vector>

#include "tools/analysis/parametric_study.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// Checks each statement of chapter 5 against two studies that differ only in the strength of the
/// excitation. If they disagree the verdict is kDepends, with both sets of numbers.
std::vector<Statement> ParametricStatements(const ParametricStudy& weak,
                                            const ParametricStudy& strong);

}  // namespace flexarm
