#pragma once

#include "controller/types/controller_config.h"
#include "controller/types/runtime_config.h"
#include "controller/types/safety_config.h"
#include "estimator/estimator_config.h"
#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// The configuration that the controller design and the control step use.
struct ControlConfig {
  ArmParameters arm;
  SensorConfig sensors;
  EstimatorConfig estimator;
  ControllerConfig controller;
  SafetyConfig safety;
  LoopConfig loop;

  /// Whether the state estimator is `ekf-payload`.
  bool uses_payload_estimator() const {
    return estimator.kind == EstimatorKind::kPayload || IsScheduled(controller.kind) ||
           Settles(controller.kind);
  }
};

}  // namespace flexarm
