#include "hal/sim/simulated_accelerometer.h"

#include <algorithm>
#include <cmath>

namespace flexarm {
namespace {

// Separate from the gauges' noise, which uses the seed itself.
constexpr std::uint64_t kAccelerometerStream = 0x74697061;

}  // namespace

SimulatedAccelerometer::SimulatedAccelerometer(const TipAccelerometerConfig& config, double step_s,
                                               std::uint64_t seed)
    : config_(config),
      blend_(1.0 - std::exp(-step_s / config.lag_s())),
      random_(seed ^ kAccelerometerStream) {}

void SimulatedAccelerometer::Step(double acceleration_m_s2) noexcept {
  filtered_m_s2_ += blend_ * (acceleration_m_s2 - filtered_m_s2_);
}

void SimulatedAccelerometer::Sample(SensorFrame* frame) noexcept {
  const double counts =
      filtered_m_s2_ / config_.m_s2_per_count() + config_.noise_counts * noise_(random_);
  const double railed = std::clamp(counts, static_cast<double>(config_.lowest_count()),
                                   static_cast<double>(config_.highest_count()));
  frame->accelerometer[0] = static_cast<std::int32_t>(std::lround(railed));
  frame->accelerometer_offset_ns[0] = 0;
  frame->accelerometer_valid = 1;
}

}  // namespace flexarm
