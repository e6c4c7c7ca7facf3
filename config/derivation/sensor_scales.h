#pragma once

#include "hal/sensor_config.h"

namespace flexarm {

/// The largest strain that the channel can show on both sides of zero.
double FullScaleStrain(const SensorConfig& sensors, const StrainChannelConfig& channel);

/// Standard deviation of the strain that a channel shows at rest, at least that of the
/// quantisation; the largest of the rig.
double StrainNoise(const SensorConfig& sensors);

/// Rate at which the counter moves by half its range in a period: its direction is ambiguous.
double AmbiguousRate_rad_s(const EncoderConfig& encoder, double period_s);

}  // namespace flexarm
