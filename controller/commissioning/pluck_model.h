#pragma once

#include <Eigen/Core>
#include <vector>

#include "controller/types/records.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// Motion of every channel over a pluck test, relative to its first samples. Rows are samples;
/// columns the four joint angles (rad), then the strain channels in config order (unit strain).
using PluckMotion = Eigen::MatrixXd;

/// The measured motion, with the signs, scales and calibration of config and run.
PluckMotion MeasuredMotion(const RigConfig& config, const std::vector<TickRecord>& run);

/// The expected motion by the model: the arm of the config, from rest at the elbow angle of the
/// first sample, under the torques that were applied.
/// @param exchanged  the two drives' torques act on each other's joint
PluckMotion ExpectedMotion(const RigConfig& config, const std::vector<TickRecord>& run,
                           bool exchanged);

}  // namespace flexarm
