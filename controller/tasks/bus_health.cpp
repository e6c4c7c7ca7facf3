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
    FollowDrives(bus, report, &reported);
    const std::uint32_t failed = bus.failed - reported.failed;
    if (bus.ok != reported.ok) {
      report(!bus.ok, bus.ok ? bus.name + ": reconnected after " + std::to_string(failed) +
                                   " failed exchanges and connection attempts"
                             : "bus lost: " + bus.fault);
    } else if (bus.ok && !bus.in_fault && failed > 0 &&
               AgeNs(now_ns, reported.at_ns) > kAtMostEveryNs) {
      report(true, bus.name + ": " + std::to_string(failed) +
                       " failed exchanges without loss of the bus" +
                       (bus.fault.empty() ? "" : "; the last: " + bus.fault));
    } else {
      continue;
    }
    reported.ok = bus.ok;
    reported.failed = bus.failed;
    reported.at_ns = now_ns;
  }
}

void BusJournal::FollowDrives(const BusHealth& bus, const Report& report, Reported* reported) {
  if (bus.in_fault != reported->in_fault) {
    reported->in_fault = bus.in_fault;
    reported->failed = bus.failed;  // the fault is the failed exchange
    report(bus.in_fault,
           bus.in_fault ? "drive in fault: " + bus.fault + ". It stays so until `flexarm reset`"
                        : bus.name + ": no drive is in fault any more");
  }
  if (bus.notice == reported->notice) return;
  reported->notice = bus.notice;
  if (!bus.notice.empty()) report(false, bus.notice);
}

}  // namespace flexarm
