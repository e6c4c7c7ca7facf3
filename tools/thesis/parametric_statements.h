#pragma once

#include <vector>

#include "tools/analysis/parametric_study.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// What chapter 5 says, statement by statement, against two studies that differ in the strength of
/// the excitation only. Where they disagree the verdict is kDepends, with both sets of numbers.
std::vector<Statement> ParametricStatements(const ParametricStudy& weak,
                                            const ParametricStudy& strong);

}  // namespace flexarm
