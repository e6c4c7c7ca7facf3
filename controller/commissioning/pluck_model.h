#pragma once

#include <Eigen/Core>
#include <vector>

#include "controller/types/records.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// Motion of every channel over a pluck test, from where it stood at first. Rows are samples;
/// columns the four joint angles (rad), then the strain channels in config order (unit strain).
using PluckMotion = Eigen::MatrixXd;

/// As the sensors say, with the signs, scales and calibration of config and run.
PluckMotion MeasuredMotion(const RigConfig& config, const std::vector<TickRecord>& run);

/// As the model says: the arm of the config, from rest at the elbow angle of the first sample,
/// under the torques that were really applied.
/// @param exchanged  the two drives' torques act on each other's joint
PluckMotion ExpectedMotion(const RigConfig& config, const std::vector<TickRecord>& run,
                           bool exchanged);

}  // namespace flexarm
