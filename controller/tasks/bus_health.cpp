#include "controller/tasks/bus_health.h"

#include "controller/safety/torque_gate.h"

namespace flexarm {
namespace {

constexpr std::int64_t kAtMostEveryNs = 1'000'000'000;

}  // namespace

void BusJournal::Follow(std::int64_t now_ns, const std::vector<BusHealth>& buses,
                        const Report& report) {
  reported_.resize(buses.size());
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const BusHealth& bus = buses[i];
    Reported& reported = reported_[i];
    const std::uint32_t failed = bus.failed - reported.failed;
    if (bus.ok != reported.ok) {
      report(!bus.ok, bus.ok ? bus.name + ": reconnected after " + std::to_string(failed) +
                                   " failed exchanges and connection attempts"
                             : "bus lost: " + bus.fault);
    } else if (bus.ok && failed > 0 && AgeNs(now_ns, reported.at_ns) > kAtMostEveryNs) {
      report(true, bus.name + ": " + std::to_string(failed) +
                       " failed exchanges without loss of the bus" +
                       (bus.fault.empty() ? "" : "; the last: " + bus.fault));
    } else {
      continue;
    }
    reported = {.ok = bus.ok, .failed = bus.failed, .at_ns = now_ns};
  }
}

}  // namespace flexarm
