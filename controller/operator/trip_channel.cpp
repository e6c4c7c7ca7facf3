#include "controller/operator/trip_channel.h"

#include "controller/runlog/csv.h"

namespace flexarm {

std::string TripChannelName(TripCause cause, std::uint32_t channel, const SensorConfig& sensors) {
  using enum TripCause;
  if (channel == 0) return {};
  if (cause == kStrainStuck || cause == kStrainSaturated || cause == kStrainOutOfFamily) {
    const std::vector<std::string> names = StrainColumns(sensors);
    return channel <= names.size() ? names[channel - 1] : std::string();
  }
  if (cause == kEncoderJump || cause == kNoCounterReading) {
    return channel <= kCounters ? CounterName(static_cast<int>(channel) - 1) : std::string();
  }
  if (cause == kBusLost || cause == kDriveFault) return {};  // named by their bus
  return "joint " + std::to_string(channel);
}

}  // namespace flexarm
