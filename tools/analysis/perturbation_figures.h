#pragma once

#include <filesystem>

#include "model/perturbation/perturbation_run.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {

/// Draws the thesis's figures 6.1 and 6.2: deviations of the tip deflections and of the joint
/// angles, linear and nonlinear model in the same axes.
/// @throws std::runtime_error if gnuplot fails
void DrawPerturbation(const ArmModel& model, const PerturbationRun& run,
                      const std::filesystem::path& output,
                      const OutputRules& rules = ReplacedPicture());

}  // namespace flexarm
