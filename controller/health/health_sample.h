#pragma once

#include <array>
#include <cstdint>

#include "estimator/piecewise_torque.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// What the parallel plant needs of a sample of the loop.
struct HealthSample {
  PiecewiseTorque applied;                    ///< over the period that ends with the sample
  std::array<double, kCounters> angle_rad;    ///< th1 th2 th3 th4, decoded
  std::array<float, kCounters> angle_late_s;  ///< read so long after the sampling instant
  std::uint32_t angles;                       ///< bit i: angle i was read
  std::uint32_t strains;                      ///< bit i: channel i was read, and is not saturated
  std::array<float, kMaxStrainChannels> strain;         ///< unit strain, calibrated
  std::array<float, kMaxStrainChannels> strain_late_s;  ///< as angle_late_s
};

}  // namespace flexarm
