#include "controller/operator/trip_channel.h"

#include "controller/runlog/csv.h"

namespace flexarm {
namespace {

const char* NameOf(LineTrouble trouble) noexcept {
  switch (trouble) {
    case LineTrouble::kReadFailed:
      return "read failed";
    case LineTrouble::kWriteFailed:
      return "write failed";
    case LineTrouble::kReadSlow:
      return "read too slow";
    case LineTrouble::kWriteSlow:
      return "write too slow";
    case LineTrouble::kRelayStuckClosed:
      return "relay stays closed";
    case LineTrouble::kRelayStuckOpen:
      return "relay stays open";
    case LineTrouble::kPumpStuckOn:
      return "charge pump stuck on";
    case LineTrouble::kVoltageMissing:
      return "no drive voltage";
    case LineTrouble::kVoltageStaysOn:
      return "drive voltage stays on";
    case LineTrouble::kVoltageUnknown:
      return "drive voltage not known";
  }
  return "";
}

}  // namespace

std::string TripChannelName(TripCause cause, std::uint32_t channel, const SensorConfig& sensors) {
  if (channel == 0) return {};
  switch (ChannelOf(cause)) {
    case TripChannel::kStrain: {
      const std::vector<std::string> names = StrainColumns(sensors);
      return channel <= names.size() ? names[channel - 1] : std::string();
    }
    case TripChannel::kCounter:
      return channel <= kCounters ? CounterName(static_cast<int>(channel) - 1) : std::string();
    case TripChannel::kJoint:
      return "joint " + std::to_string(channel);
    case TripChannel::kLineTrouble:
      return NameOf(static_cast<LineTrouble>(channel));
    case TripChannel::kNone:
    case TripChannel::kBus:  // LoopStack::BusText names it
      return {};
  }
  return {};
}

}  // namespace flexarm
