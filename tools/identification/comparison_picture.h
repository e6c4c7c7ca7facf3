#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/identification/run_comparison.h"

namespace flexarm {

/// A run and what the model says of it, for a column of the picture.
struct ComparisonColumn {
  std::string title;
  const RunComparison* run;
  Eigen::MatrixXd predicted;
};

/// Draws measured and predicted signals, one below the other, one column a run. .png or .svg.
/// @throws std::runtime_error if gnuplot is missing or fails
void DrawComparison(const std::vector<ComparisonColumn>& column,
                    const std::filesystem::path& output);

}  // namespace flexarm
