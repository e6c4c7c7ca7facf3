#pragma once

#include <cstdint>
#include <random>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// The accelerometer at the simulated arm's tip: analogue filter, noise, rounding and saturation.
///
/// The filter is exact for an acceleration that is constant during a step; it starts at rest. Noise
/// has its own generator, so that this sensor does not change the noise of the gauges.
/// Real-time: all but the constructor are safe.
class SimulatedAccelerometer {
 public:
  SimulatedAccelerometer(const TipAccelerometerConfig& config, double step_s, std::uint64_t seed);

  /// One step of the plant with this acceleration at its middle.
  void Step(double acceleration_m_s2) noexcept;

  /// Writes the present reading into the frame, at its sampling instant.
  void Sample(SensorFrame* frame) noexcept;

 private:
  TipAccelerometerConfig config_;
  double blend_;  // 1 - exp(-w h)
  double filtered_m_s2_ = 0.0;
  std::mt19937_64 random_;
  std::normal_distribution<double> noise_;
};

}  // namespace flexarm
