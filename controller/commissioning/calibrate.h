#pragma once

#include <array>
#include <string>
#include <utility>

#include "controller/commissioning/rest_readings.h"
#include "estimator/calibration.h"
#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

inline constexpr double kLargestZero = 0.25;      ///< of the converter's range to either side
inline constexpr double kLargestGainError = 0.3;  ///< to either side

// Calibration of the sensors from readings of an arm at rest. Each function rejects implausible
// readings and names every channel that has them. Not real-time.

/// Tare: the strain zeros. At rest nothing bends a planar arm, so every channel reads its zero.
/// @throws RejectedError naming the channels that are missing, unsteady (more than six times the
///         noise of the config), or further from zero than a quarter of the converter's range
Calibration Tare(const SensorConfig& sensors, const RestReadings& readings, Calibration before);

/// The counter zeros, from the present angles of the hubs; the rotors are at the angles of their
/// hubs.
/// @throws RejectedError naming the encoders that were not read, or moved
Calibration Zero(const SensorConfig& sensors, const RestReadings& readings,
                 const std::array<double, 2>& hub_rad, Calibration before);

/// The first value of a calibration that no command above could have given: a gain error beyond
/// 30 %, a strain zero beyond a quarter of the range, a counter zero more than two turns beyond the
/// counter's range. "strain_1_01: gain_error = -2, expected -0.3 to 0.3"; empty if there is none.
std::string OutOfRange(const SensorConfig& sensors, const Calibration& calibration);

/// A known force on a link whose root is clamped: a weight over a pulley, normal to the link.
struct StaticLoad {
  int link;        ///< 1 or 2
  double force_n;  ///< towards +w: counter-clockwise about the joint is positive
  double at_m;     ///< from the root of the link
};

/// Surface strain (h/2) w'' of a clamped link under `load`, as a channel of face +1 at `x_m` reads
/// it: a bending moment of F (at - x) up to the force, zero beyond it.
double StaticStrain(const LinkParameters& link, const StaticLoad& load, double x_m);

/// The gains of a link's strain channels by least squares over several known loads.
class GainCalibration {
 public:
  GainCalibration(ArmParameters arm, SensorConfig sensors)
      : arm_(std::move(arm)), sensors_(std::move(sensors)) {}

  /// Adds one load. A channel that it strains by less than twenty counts is not updated.
  /// @returns `before` with the gains of that link's channels
  /// @throws RejectedError naming the channels that are missing or unsteady, or whose gain would
  ///         change by more than 30 %: an inverted or exchanged gauge, or another load than stated
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
