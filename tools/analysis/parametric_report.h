#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/analysis/parametric_study.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// The results of every run, without the spectra, and the statements.
nlohmann::ordered_json ParametricJson(const ParametricStudy& study,
                                      const std::vector<Statement>& statements);

/// Prints the lowest frequencies and the largest bending of every run to standard output.
void PrintSweeps(const ParametricStudy& study);

/// Prints the statements as text to standard output.
void PrintStatements(const std::vector<Statement>& statements);

/// Draws the pictures that correspond to figures 5.1 to 5.5 of the thesis into a folder, which is
/// created if it does not exist: spectra over each parameter, and largest bending and twist. Also
/// writes parametric.csv (one row per run) and, if there are any, statements.md.
/// @returns the files written
/// @throws std::runtime_error if gnuplot or the folder fails
std::vector<std::filesystem::path> WriteParametricFolder(const ParametricStudy& study,
                                                         const std::vector<Statement>& statements,
                                                         const std::filesystem::path& folder);

}  // namespace flexarm
