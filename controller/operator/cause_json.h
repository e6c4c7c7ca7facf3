#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "controller/types/present_causes.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// LoopStack::BusText.
using BusTextOf = std::function<std::string(TripCause cause, const Evidence& evidence)>;

/// A cause with what breaks its limit: {"name", "number", "value", "limit", "unit", "channel",
/// "channel_name", "bus"}. Value, limit and unit are null if they are not known, the bus if it is
/// of none.
nlohmann::json CauseJson(TripCause cause, const Evidence& evidence, const SensorConfig& sensors,
                         const BusTextOf& bus_text);

/// The same of every cause that is present, by number.
nlohmann::json PresentJson(const PresentCauses& present, const SensorConfig& sensors,
                           const BusTextOf& bus_text);

/// Their names, by number.
nlohmann::json NamesJson(TripCauses causes);

}  // namespace flexarm
