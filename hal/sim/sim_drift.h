#pragma once

#include <array>
#include <vector>

#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"
#include "model/problem.h"

namespace flexarm {

/// How the simulated rig differs from its config, section [sim.drift]: what wear, glue and a wrong
/// payload do to a real one. Unknown to the loop, the design and the payload in the log.
///
/// Errors are relative: 0.01 is one per cent above the config. A list of the gauges has a number
/// for each strain channel, in config order; those that it lacks are 0.
struct SimDrift {
  std::vector<double> gauge_gain_error;    ///< relative
  std::vector<double> gauge_zero_share;    ///< of the converter's full scale, 2^(bits - 1) counts
  std::array<double, 2> friction_error{};  ///< of the Coulomb friction of joint 1, 2
  std::array<double, 2> joint_stiffness_error{};  ///< of joint 1, 2
  std::array<double, 2> link_stiffness_error{};   ///< of the bending stiffness of link 1, 2
  double payload_error_kg = 0.0;                  ///< more than the payload that is stated

  std::vector<Problem> Problems() const;
};

/// The arm and the sensors with the drift. Not real-time safe.
ArmParameters Drifted(ArmParameters arm, const SimDrift& drift);
SensorConfig Drifted(SensorConfig sensors, const SimDrift& drift);

}  // namespace flexarm
