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

  /// Why the law `sobel` does not bring the arm to rest, and so is `sobel-thesis`; null: it does.
  const char* why_not_settling() const {
    if (!controller.settling) return "the config has no table [controller.settling]";
    if (controller.nominal != kR12) return "it needs controller.nominal = \"R12\"";
    if (estimator.kind != EstimatorKind::kKalman) return "it needs estimator.name = \"kalman\"";
    if (!estimator.payload || !controller.payload) {
      return "it needs the tables [estimator.payload] and [controller.payload]";
    }
    return nullptr;
  }

  /// Whether the law brings the arm to rest with the payload filter beside the Kalman filter
  /// (settle_term.h, settling_observer.h).
  bool settles() const { return LawOf(controller.kind).settles && why_not_settling() == nullptr; }

  /// Whether `ekf-payload` runs.
  bool uses_payload_estimator() const {
    return estimator.kind == EstimatorKind::kPayload || IsScheduled(controller.kind) || settles();
  }
};

}  // namespace flexarm
