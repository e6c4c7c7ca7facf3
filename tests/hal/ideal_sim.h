#pragma once

#include "hal/sim/sim_config.h"

namespace flexarm {

/// A simulation without losses and delays: every frame arrives, at once, without channel skew.
constexpr SimConfig IdealSim(int plant_modes, double step_ms) {
  return {.plant_modes = plant_modes,
          .step_ms = step_ms,
          .seed = 1,
          .motor_lag_ms = {2.0, 2.0},
          .transport_delay_ms = 0.0,
          .lost_frame_fraction = 0.0,
          .channel_skew_us = 0.0,
          .switch_angle_deg = {95.0, 95.0}};
}

}  // namespace flexarm
