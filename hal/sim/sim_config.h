#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// The simulated rig, section [sim]: what a real rig does not need to be told.
struct SimConfig {
  int plant_modes;                     ///< bending modes a link of the plant, 1..6
  double step_ms;                      ///< integration step, divides 1 ms
  std::uint64_t seed;                  ///< of the measurement noise
  std::array<double, 2> motor_lag_ms;  ///< electrical time constant of (3.24); 0: none
  double transport_delay_ms;           ///< from command to drive, on top of the loop's own; 0..20
  std::array<double, 2> switch_angle_deg;  ///< limit switches open beyond +-this hub angle

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
