#include "controller/tasks/bus_health.h"

#include "controller/safety/torque_gate.h"

namespace flexarm {
namespace {

constexpr std::int64_t kAtMostEveryNs = 1'000'000'000;

}  // namespace

void BusJournal::Follow(std::int64_t now_ns, const std::vector<BusHealth>& buses,
                        const Report& report) {
  told_.resize(buses.size());
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const BusHealth& bus = buses[i];
    Told& told = told_[i];
    const std::uint32_t failed = bus.failed - told.failed;
    if (bus.ok != told.ok) {
      report(!bus.ok, bus.ok ? bus.name + ": reconnected after " + std::to_string(failed) +
                                   " failed exchanges and connection attempts"
                             : "bus lost: " + bus.fault);
    } else if (bus.ok && failed > 0 && AgeNs(now_ns, told.at_ns) > kAtMostEveryNs) {
      report(true, bus.name + ": " + std::to_string(failed) +
                       " failed exchanges without loss of the bus" +
                       (bus.fault.empty() ? "" : "; the last: " + bus.fault));
    } else {
      continue;
    }
    told = {.ok = bus.ok, .failed = bus.failed, .at_ns = now_ns};
  }
}

}  // namespace flexarm
