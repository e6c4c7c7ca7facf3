#include "controller/operator/bus_counter_record.h"

#include <utility>

#include "controller/operator/status_json.h"

namespace flexarm {

void BusCounterRecord::Follow(std::int64_t now_ns, SafetyState state,
                              const std::vector<BusHealth>& buses) {
  const bool before = std::exchange(torque_, TorqueAllowed(state));
  if (!before || torque_ || buses.empty()) return;
  nlohmann::json all = nlohmann::json::object();
  for (const BusHealth& bus : buses) all[bus.name] = CountersJson(bus.counters);
  events_->Push({.time_ns = now_ns,
                 .kind = "counters",
                 .name = "buses",
                 .text = "what the drivers rejected or missed since the start",
                 .value_json = all.dump()});
}

}  // namespace flexarm
