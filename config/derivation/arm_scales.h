#pragma once

#include <array>

#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// What the derived values of a config depend on: the keys that only the owner of the arm knows.
struct TuningBasis {
  ArmParameters arm;
  SensorConfig sensors;
  double period_s;
  std::array<double, 2> torque_limit_nm;  ///< at the gearbox output
  std::array<double, 2> strain_limit;     ///< NaN: derived from the full scale of the gauges
  std::array<double, 2> payload_range_kg;
};

/// The scales of an arm, one of each joint or of its link, in which every derived value is
/// expressed (docs/theory/derivation.md 1).
struct ArmScales {
  std::array<double, 2> strain_limit;  ///< surface strain at the root
  /// S: the smaller of the torque limit and the torque that bends the link to its strain limit; of
  /// the elbow also the one that bends link 1 to its limit, which bears the reaction.
  std::array<double, 2> torque_nm;
  std::array<double, 2> inertia_kgm2;   ///< J: about the joint, arm straight, nominal payload
  std::array<double, 2> deflection_m;   ///< d: of the link's end in its first mode at that limit
  std::array<double, 2> length_m;       ///< L
  std::array<double, 2> torsion_rad;    ///< S / K: twist of the joint
  std::array<double, 2> friction_nm;    ///< F: Coulomb friction, at least a thousandth of the limit
  std::array<double, 2> modal_noise_m;  ///< of the first modal coordinate, from the gauges' noise
  /// Lowest undamped frequency with the greatest payload and free hubs, elbow straight.
  double torque_mode_hz;
  /// Rate at which the coarsest counter turns by half its range in a period.
  double ambiguous_rate_rad_s;
};

/// @throws std::invalid_argument if the arm has no mode shapes
ArmScales ScalesOf(const TuningBasis& basis);

}  // namespace flexarm
