#pragma once

#include <array>

#include "estimator/estimator_config.h"
#include "estimator/kalman_design.h"
#include "estimator/nominal_model.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/loop_time.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {

/// Stiffness of the joints of the simulated rig, N m/rad.
inline constexpr std::array<double, 2> kStiffness = {761.59, 497.96};

/// The estimator of the simulated rig (docs/theory/control-law.md 7.3).
inline EstimatorConfig ThesisEstimator(EstimatorKind kind = EstimatorKind::kKalman) {
  return {.kind = kind,
          .modes_per_link = 2,
          .process_force = {0.3, 0.05, 5.0, 5.0, 1.5, 1.5},
          .rotor_extra_sigma_rad = {3e-4, 3e-4},
          .hub_extra_sigma_rad = {},
          .modal_sigma_m = {2e-4, 1e-4, 2e-4, 1e-4},
          .max_joint_rate_rad_s = 14.0,
          .hub_rotor_limit_rad = 0.1,
          .strain_family_limit = 4e-4,
          .strain_stuck_limit = 1e-4,
          .innovation_limit_rad = 0.35,
          .fault_ticks = 3};
}

inline KalmanDesign ThesisFilter(const SensorConfig& sensors = ThesisSensors(),
                                 const StateLayout& layout = kR12) {
  return DesignKalmanFilter(MakeNominalModel(ThesisRig(), layout), ThesisRig(), sensors,
                            ThesisEstimator(), kPeriod_s);
}

}  // namespace flexarm
