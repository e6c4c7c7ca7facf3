#pragma once

#include <string>
#include <vector>

#include "hal/sensor_config.h"

namespace flexarm {

// Overrides for better sensors than the config's, in the form of --set: for the simulated rig and
// for the controller, because both must know the size of a count.

/// Every encoder `times` finer, with wider counters in proportion, of 32 bits at most.
/// @param hub1_only  only the encoder of theta_1
std::vector<std::string> FinerEncoders(const SensorConfig& sensors, double times,
                                       bool hub1_only = false);

/// Gauges without noise, and a converter of 24 bits, whose quantisation is negligible.
std::vector<std::string> QuietGauges();

}  // namespace flexarm
