#include "hal/hal_config.h"

#include <array>
#include <string>

#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, kCounters> kEncoders = {"hub1", "hub2", "rotor1", "rotor2"};

void Append(const std::vector<Problem>& more, std::vector<Problem>* all) {
  all->insert(all->end(), more.begin(), more.end());
}

void RequireOnce(int times, const std::string& key, const std::string& what, ProblemList* list) {
  list->Require(times == 1, key, std::to_string(times) + " times",
                "must be wired exactly once: " + what);
}

// How often every counter, drive and strain channel is wired.
struct Census {
  std::array<int, kCounters> counter{};
  std::array<int, 2> drive{};
  std::vector<int> strain;
};

Census Count(const HalConfig& hal, std::size_t strain_rows) {
  Census census;
  census.strain.resize(strain_rows);
  for (const CanopenConfig& bus : hal.canopen) {
    for (const CanopenNodeConfig& node : bus.node) {
      if (IsDrive(node.role)) ++census.drive[static_cast<std::size_t>(node.role)];
      if (node.counter() >= 0) ++census.counter[static_cast<std::size_t>(node.counter())];
    }
  }
  for (const ModbusDeviceConfig& device : hal.modbus.device) {
    for (const ModbusRegister& row : device.map) {
      const bool known = row.index >= 0 && static_cast<std::size_t>(row.index) < strain_rows;
      if (row.role == ModbusRole::kStrain && known)
        ++census.strain[static_cast<std::size_t>(row.index)];
    }
  }
  return census;
}

void CheckWiring(const HalConfig& hal, const SensorConfig& sensors, ProblemList* list) {
  const Census census = Count(hal, sensors.strain.size());
  for (std::size_t i = 0; i < kCounters; ++i) {
    const bool present = (sensors.counters_present() >> i & 1u) != 0;
    if (!present && census.counter[i] == 0) continue;
    RequireOnce(census.counter[i], std::string("canopen role ") + kEncoders[i],
                present ? "the encoder of [[sensors.encoder]]"
                        : "and there is no such encoder in [[sensors.encoder]]",
                list);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    RequireOnce(census.drive[i], "canopen role drive" + std::to_string(i + 1),
                "the drive of a joint", list);
  }
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    RequireOnce(census.strain[i], ProblemList::Element("modbus strain", i),
                "the channel of [[sensors.strain]]", list);
  }
  list->Require(hal.gpiod.has_value(), "gpiod", "missing",
                "must be there: limit switches, emergency stop, relay and charge pump");
}

void CheckDrives(const HalConfig& hal, std::int64_t available_ns,
                 const std::array<double, 2>& torque_limit_nm, ProblemList* list) {
  for (std::size_t b = 0; b < hal.canopen.size(); ++b) {
    const CanopenConfig& bus = hal.canopen[b];
    const std::string row = ProblemList::Element("canopen", b);
    list->Require(bus.worst_case_exchange_ns() <= available_ns, row + ".answer_timeout_ms",
                  NumberText(bus.answer_timeout_ms),
                  "must leave room: one exchange takes up to " +
                      std::to_string(bus.worst_case_exchange_ns() / 1000) + " us, " +
                      std::to_string(available_ns / 1000) +
                      " us are there (loop.acquire_before_ms)");
    for (std::size_t n = 0; n < bus.node.size(); ++n) {
      const CanopenNodeConfig& node = bus.node[n];
      if (!IsDrive(node.role)) continue;
      const double limit = torque_limit_nm[static_cast<std::size_t>(node.role)];
      list->Require(node.torque_range_nm >= limit,
                    row + "." + ProblemList::Element("node", n) + ".torque_range_nm",
                    NumberText(node.torque_range_nm),
                    "must cover limits.torque_limit_nm = " + NumberText(limit) +
                        ": the loop would ask for more than the drive can give");
    }
  }
}

}  // namespace

std::vector<Problem> HalConfig::Problems(const SensorConfig& sensors, std::int64_t available_ns,
                                         const std::array<double, 2>& torque_limit_nm) const {
  if (empty()) return {};
  std::vector<Problem> all = modbus.Problems(sensors.strain.size(), available_ns);
  for (std::size_t i = 0; i < canopen.size(); ++i) {
    Append(canopen[i].Problems(ProblemList::Element("hal.canopen", i) + "."), &all);
  }
  if (gpiod) Append(gpiod->Problems(), &all);
  ProblemList list("hal.");
  CheckWiring(*this, sensors, &list);
  CheckDrives(*this, available_ns, torque_limit_nm, &list);
  Append(list.Take(), &all);
  return all;
}

}  // namespace flexarm
