#pragma once

#include <array>
#include <utility>

#include "controller/commissioning/rest_readings.h"
#include "estimator/calibration.h"
#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

// Sensors calibrated from readings of a still arm. Each function refuses what cannot be right, and
// names every channel that is not. Not real-time.

/// The strain zeros: nothing bends a planar arm at rest, so every channel reads its zero.
/// @throws Refused naming the channels that are missing, unsteady (more than six times the noise
///         that the config expects), or further from zero than a quarter of the converter's range
Calibration Tare(const SensorConfig& sensors, const RestReadings& readings, Calibration before);

/// The counter zeros, from the angles at which the hubs stand now; the rotors stand with their
/// hubs.
/// @throws Refused naming the encoders that were not read, or moved
Calibration Zero(const SensorConfig& sensors, const RestReadings& readings,
                 const std::array<double, 2>& hub_rad, Calibration before);

/// A known force on a link whose root is held: hung over a pulley, square to the link.
struct StaticLoad {
  int link;        ///< 1 or 2
  double force_n;  ///< towards +w: counter-clockwise about the joint is positive
  double at_m;     ///< from the root of the link
};

/// Surface strain (h/2) w'' of a held link under `load`, as a channel of face +1 at `x_m` reads it:
/// a bending moment of F (at - x) up to the force, nothing beyond it.
double StaticStrain(const LinkParameters& link, const StaticLoad& load, double x_m);

/// The gains of a link's strain channels by least squares over several known loads.
class GainCalibration {
 public:
  GainCalibration(ArmParameters arm, SensorConfig sensors)
      : arm_(std::move(arm)), sensors_(std::move(sensors)) {}

  /// One more load. A channel that it strains by less than twenty counts learns nothing from it.
  /// @returns `before` with the gains of that link's channels
  /// @throws Refused naming the channels that are missing or unsteady, or whose gain would change
  ///         by more than 30 %: an inverted or exchanged gauge, or another load than was said
  Calibration Add(const StaticLoad& load, const RestReadings& readings, Calibration before);

 private:
  struct Sums {
    double expected_squared = 0.0;
    double expected_times_measured = 0.0;
  };

  ArmParameters arm_;
  SensorConfig sensors_;
  std::array<Sums, kMaxStrainChannels> sums_{};
};

}  // namespace flexarm
