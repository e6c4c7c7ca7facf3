#pragma once

#include <functional>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// First line of the page, by which flexarm knows its own.
inline constexpr const char* kThesisCheckTitle = "# What the thesis says, and what the model says";

/// Chapter 3's beams: the lumped transfer matrix and the fitted shapes against the exact ones.
std::vector<Statement> BeamStatements(const ArmParameters& arm);

/// Chapter 3 against the model: beams, damping, backlash, kinematics.
std::vector<Statement> Chapter3Statements(const RigConfig& config);

/// Chapter 4: the rig's choice of flexibilities and its table of parameters, the experiment.
std::vector<Statement> Chapter4Statements(const RigConfig& config);

/// Chapter 6: linearisation, power balancing, order reduction over the whole grid.
std::vector<Statement> Chapter6Statements(const RigConfig& config);

/// All of chapters 3 to 7 and Appendix B, chapter 5 by ParametricStatements and 7 by
/// Chapter7Statements, in the order of their sections.
/// @param first_seed  of the closed loops of chapter 7
/// @param progress  called with the number of chapters done; may be empty
std::vector<Statement> ThesisStatements(const RigConfig& config, int first_seed = 1,
                                        const std::function<void(std::size_t)>& progress = {});

/// The page docs/thesis-check.md: introduction and table. Every number in it is computed, except
/// those that the thesis states.
std::string ThesisCheckPage(const RigConfig& config, const std::vector<Statement>& statements);

}  // namespace flexarm
