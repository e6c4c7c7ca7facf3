#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "controller/files/write_file.h"
#include "tools/identification/run_comparison.h"

namespace flexarm {

/// A run and its prediction by the model: one column of the picture.
struct ComparisonColumn {
  std::string title;
  const RunComparison* run;
  Eigen::MatrixXd predicted;
};

/// Draws measured and predicted signals below each other, one column per run. .png or .svg.
/// @throws std::runtime_error if gnuplot is missing or fails
void DrawComparison(const std::vector<ComparisonColumn>& column,
                    const std::filesystem::path& output, const OutputRules& rules);

}  // namespace flexarm
