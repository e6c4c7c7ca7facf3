#pragma once

#include <vector>

#include "tools/analysis/parametric_study.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// Checks each statement of chapter 5 against two studies that differ only in the strength of the
/// excitation. If they disagree the verdict is kDepends, with both sets of numbers.
std::vector<Statement> ParametricStatements(const ParametricStudy& weak,
                                            const ParametricStudy& strong);

/// (3.24) in the simulations of chapters 4 and 5, which the thesis has there without stating its
/// time constants: what a lag of 10 ms changes of a study.
Statement MotorLag(const RigConfig& config, const ParametricStudy& study);

}  // namespace flexarm
