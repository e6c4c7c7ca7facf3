#pragma once

#include "controller/commissioning/commissioning_config.h"
#include "controller/law/controller_config.h"
#include "controller/runtime/runtime_config.h"
#include "controller/safety/safety_config.h"
#include "estimator/estimator_config.h"
#include "hal/hal_config.h"
#include "hal/sensor_config.h"
#include "hal/sim/sim_config.h"
#include "model/arm_parameters.h"

namespace flexarm {

/// Everything that the loop and its tasks are built from: the plain structs of every folder.
struct StackConfig {
  ArmParameters arm;
  SensorConfig sensors;
  SimConfig sim;
  HalConfig hal;
  EstimatorConfig estimator;
  ControllerConfig controller;
  SafetyConfig safety;
  CommissioningConfig commissioning;
  LoopConfig loop;
  DaemonConfig daemon;

  /// Whether the state comes from `ekf-payload`.
  bool uses_payload_estimator() const {
    return estimator.kind == EstimatorKind::kPayload || IsScheduled(controller.kind);
  }
};

}  // namespace flexarm
