#pragma once

#include "config/config.h"
#include "config/table_reader.h"

namespace flexarm {

// The sections of a rig, each read into its struct, by the file that is named after them. `root` is
// the whole document.

/// [link1] [link2] [joint1] [joint2] [arm]
void ReadArm(TableReader root, ArmParameters* out);
/// [sensors]
void ReadSensors(TableReader sensors, SensorConfig* out);
/// [estimator]
void ReadEstimator(TableReader estimator, EstimatorConfig* out);
/// [controller]
void ReadController(TableReader controller, ControllerConfig* out);
/// [limits] [safety]
void ReadSafety(TableReader root, SafetyConfig* out);
/// [commissioning]
void ReadCommissioning(TableReader commissioning, CommissioningConfig* out);

}  // namespace flexarm
