#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "tools/analysis/parametric_study.h"
#include "tools/analysis/statement.h"

namespace flexarm {

/// Every run's figures, without the spectra, and the statements.
nlohmann::ordered_json ParametricJson(const ParametricStudy& study,
                                      const std::vector<Statement>& statements);

/// The statements for people, on standard output.
void PrintStatements(const std::vector<Statement>& statements);

/// Draws the pictures that correspond to figures 5.1 to 5.5 of the thesis into a folder, which is
/// made if need be: spectra over each parameter, and largest bending and twist. With them
/// parametric.csv (a row a run) and statements.md.
/// @returns the files
/// @throws std::runtime_error if gnuplot or the folder fails
std::vector<std::filesystem::path> WriteParametricFolder(const ParametricStudy& study,
                                                         const std::vector<Statement>& statements,
                                                         const std::filesystem::path& folder);

}  // namespace flexarm
