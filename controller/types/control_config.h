#pragma once

#include "controller/types/controller_config.h"
#include "controller/types/runtime_config.h"
#include "controller/types/safety_config.h"
#include "estimator/estimator_config.h"
#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// What the design of the controller and its step depend on.
struct ControlConfig {
  ArmParameters arm;
  SensorConfig sensors;
  EstimatorConfig estimator;
  ControllerConfig controller;
  SafetyConfig safety;
  LoopConfig loop;

  /// Whether the state comes from `ekf-payload`.
  bool uses_payload_estimator() const {
    return estimator.kind == EstimatorKind::kPayload || IsScheduled(controller.kind);
  }
};

}  // namespace flexarm
