#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"
#include "model/arm/arm_model.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// Converts the state of the simulated arm into the raw counts of the rig's converters.
///
/// Encoders round to the nearest count and wrap at their counter's width. Strain channels read the
/// modal coordinates behind the gauges' analogue filter, then noise, rounding and saturation. Noise
/// comes from one seeded generator, drawn channel by channel in config order: same seed, same
/// frames. Real-time: Sample is safe.
class SimulatedSensors {
 public:
  SimulatedSensors(const ArmModel& arm, const SensorConfig& sensors, std::uint64_t seed)
      : SimulatedSensors(arm, sensors, seed, ArmVector::Zero(arm.dof())) {}
  /// @param start  coordinates of the arm when it is switched on: the counters read 0 there
  SimulatedSensors(const ArmModel& arm, const SensorConfig& sensors, std::uint64_t seed,
                   const ArmVector& start);

  /// @param q         coordinates of the arm at the sampling instant
  /// @param filtered  its modal coordinates behind the gauge filter, size dof - 4
  SensorFrame Sample(std::int64_t now_ns, const ArmVector& q, const ArmVector& filtered,
                     LineLevels levels) noexcept;

  /// The same without strain channels, which SampleStrain adds one by one.
  SensorFrame SampleCounters(std::int64_t now_ns, const ArmVector& q,
                             LineLevels levels) const noexcept;

  /// Strain channel `i`, sampled `offset_ns` after the frame. In order of `i`.
  void SampleStrain(std::size_t i, std::int32_t offset_ns, const ArmVector& filtered,
                    SensorFrame* frame) noexcept;

  std::size_t strain_channels() const noexcept { return gauge_.size(); }

 private:
  struct Encoder {
    std::size_t counter;
    double counts_per_rad;  // signed
    std::int64_t start;     // counts at the start, from angle 0
    std::int64_t modulus;
  };
  struct Gauge {
    double offset_counts;
    Eigen::Index first;                    // of its link's modal coordinates in `filtered`
    std::vector<double> counts_per_metre;  // of every modal coordinate of its link
  };

  std::vector<Encoder> encoder_;
  std::vector<Gauge> gauge_;
  StrainInputConfig input_;
  std::mt19937_64 random_;
  std::normal_distribution<double> noise_;
};

}  // namespace flexarm
