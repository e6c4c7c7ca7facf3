#pragma once

#include <cstdint>
#include <string>

#include "controller/types/records.h"
#include "estimator/state_layout.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// Key "telemetry" of each line. A change that a receiver does not understand raises it.
inline constexpr int kTelemetryVersion = 1;

/// What a line needs of the rig's config.
struct TelemetrySource {
  std::string rig;
  SensorConfig sensors;
  StateLayout layout;
};

/// A sample as one JSON object without newline, with the keys of docs/telemetry.md; null: not
/// known. Numbers have seven digits, times all of theirs. Pure function. Not real-time safe.
/// @param timestamp_s  of the sampling instant, seconds of UTC since 1970
/// @param lost  samples that were not sent so far
std::string TelemetryLine(const TelemetrySource& source, const TickRecord& tick, double timestamp_s,
                          std::uint64_t lost);

}  // namespace flexarm
