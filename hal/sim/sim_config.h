#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hal/sim/sim_drift.h"
#include "model/problem.h"

namespace flexarm {

/// The simulated rig, section [sim]: parameters that a real rig does not need.
struct SimConfig {
  int plant_modes;                     ///< bending modes per link of the plant, 1..6
  double step_ms;                      ///< integration step, divides 1 ms
  std::uint64_t seed;                  ///< of the measurement noise
  std::array<double, 2> motor_lag_ms;  ///< electrical time constant of (3.24); 0: none
  double transport_delay_ms;   ///< from command to drive, in addition to the loop's own; 0..40
  double lost_frame_fraction;  ///< fraction of frames without a reading, never two in a row; 0..0.5
  double channel_skew_us;  ///< strain channel i is sampled i times this after k Ts; 0: all at k Ts
  std::array<double, 2> switch_angle_deg;  ///< limit switches open beyond +-this hub angle
  SimDrift drift{};                        ///< of the plant and its sensors, unknown to the loop

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
