#pragma once

#include "estimator/payload_estimator.h"
#include "tests/estimator/thesis_estimator.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {

/// The settings of docs/theory/payload.md 2.
inline EstimatorConfig StudyEstimator() {
  EstimatorConfig config = ThesisEstimator(EstimatorKind::kPayload);
  config.payload = {.process_force = {0.1, 0.02, 0.7, 0.7, 0.2, 0.2},
                    .rotor_extra_sigma_rad = {3e-4, 1e-3},
                    .start_kg = 0.2,
                    .start_sigma_kg = 0.4,
                    .max_kg = 1.1,
                    .move_sigma_kg = 0.1,
                    .walk_kg = 0.003,
                    .min_rate_rad_s = 0.03,
                    .friction_start_sigma_nm = {0.1, 0.01},
                    .friction_max_nm = {1.0, 0.2},
                    .friction_walk_nm = {0.004, 0.0004},
                    .friction_min_rate_rad_s = 0.05,
                    .play_threshold_counts = 1.5,
                    .play_memory = 0.999,
                    .gate_sigmas = 4.0,
                    .detect_delay = true};
  return config;
}

/// The filter of the design study on its rig.
inline PayloadFilterConfig StudyPayload() {
  return PayloadFilterFor(ThesisRig(), ThesisSensors(), StudyEstimator());
}

}  // namespace flexarm
