#include "controller/operator/cause_json.h"

#include <nlohmann/json.hpp>

#include "controller/operator/trip_channel.h"
#include "controller/types/trip_advice.h"

namespace flexarm {

nlohmann::json CauseJson(TripCause cause, const Evidence& evidence, const SensorConfig& sensors,
                         const BusTextOf& bus_text) {
  nlohmann::json json{{"name", ToString(cause)},
                      {"number", static_cast<int>(cause)},
                      {"value", nullptr},
                      {"limit", nullptr},
                      {"unit", nullptr},
                      {"channel", evidence.channel},
                      {"channel_name", TripChannelName(cause, evidence.channel, sensors)},
                      {"bus", nullptr}};
  if (evidence.value != 0.0 || evidence.limit != 0.0) {
    json["value"] = evidence.value;
    json["limit"] = evidence.limit;
    if (const std::string unit = EvidenceUnit(cause); !unit.empty()) json["unit"] = unit;
  }
  if (std::string bus = bus_text(cause, evidence); !bus.empty()) json["bus"] = std::move(bus);
  return json;
}

nlohmann::json PresentJson(const PresentCauses& present, const SensorConfig& sensors,
                           const BusTextOf& bus_text) {
  nlohmann::json all = nlohmann::json::array();
  for (int number = 0; number < kTripCauses; ++number) {
    const auto cause = static_cast<TripCause>(number);
    if ((present.causes & CauseBit(cause)) == 0) continue;
    const Evidence& evidence = present.evidence[static_cast<std::size_t>(number)];
    all.push_back(CauseJson(cause, evidence, sensors, bus_text));
  }
  return all;
}

nlohmann::json NamesJson(TripCauses causes) {
  nlohmann::json names = nlohmann::json::array();
  for (int number = 0; number < kTripCauses; ++number) {
    const auto cause = static_cast<TripCause>(number);
    if ((causes & CauseBit(cause)) != 0) names.push_back(ToString(cause));
  }
  return names;
}

}  // namespace flexarm
