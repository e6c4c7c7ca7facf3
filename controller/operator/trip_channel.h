#pragma once

#include <string>

#include "controller/types/trip_cause.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// What the channel of a trip's evidence is: "joint 2", "hub1", "strain_2_04"; empty for none.
/// @param channel  1-based, as Evidence has it; 0: none
std::string TripChannelName(TripCause cause, std::uint32_t channel, const SensorConfig& sensors);

}  // namespace flexarm
