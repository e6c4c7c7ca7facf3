#pragma once

#include <filesystem>

#include "model/perturbation/perturbation_run.h"

namespace flexarm {

/// Draws what the thesis's figures 6.1 and 6.2 show: deviations of the tips' deflections and of the
/// joint angles, linear over nonlinear.
/// @throws std::runtime_error if gnuplot fails
void DrawPerturbation(const ArmModel& model, const PerturbationRun& run,
                      const std::filesystem::path& output);

}  // namespace flexarm
