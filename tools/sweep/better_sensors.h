#pragma once

#include <string>
#include <vector>

#include "hal/sensor_config.h"

namespace flexarm {

// Rigs whose sensors are better than the config's, in the form of --set: for the simulated rig and
// the controller alike, as both have to know what a count is.

/// Every encoder `times` finer, with counters that are as much wider.
/// @param hub1_only  that of theta_1 alone
std::vector<std::string> FinerEncoders(const SensorConfig& sensors, double times,
                                       bool hub1_only = false);

/// Gauges without noise, and a converter whose counts are too small to matter.
std::vector<std::string> QuietGauges();

}  // namespace flexarm
