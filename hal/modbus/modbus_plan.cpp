#include "hal/modbus/modbus_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "hal/time_units.h"

namespace flexarm {
namespace {

constexpr int kMostRegisters = 125;  // Modbus application protocol V1.1b3, 6.3
constexpr int kMostBits = 2000;      // 6.1
// System calls, the driver's own work, and the granularity of select (1 us and timer slack 50 us).
constexpr std::int64_t kOverheadNs = 200'000;

struct Span {
  ModbusTable table;
  int address;
  int count;
  int row;
};

int MostPerRequest(ModbusTable table) { return HoldsBits(table) ? kMostBits : kMostRegisters; }

// Greedy from the lowest address, which gives the fewest requests.
std::vector<ModbusRequest> Group(std::vector<Span> spans, int gap_limit) {
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return a.table != b.table ? a.table < b.table : a.address < b.address;
  });
  std::vector<ModbusRequest> requests;
  for (const Span& span : spans) {
    if (!requests.empty()) {
      ModbusRequest& last = requests.back();
      const int last_end = last.address + last.count;
      const int joined = std::max(last_end, span.address + span.count) - last.address;
      if (last.table == span.table && span.address - last_end <= gap_limit &&
          joined <= MostPerRequest(span.table)) {
        last.count = joined;
        last.rows.push_back(span.row);
        continue;
      }
    }
    requests.push_back({.table = span.table,
                        .address = span.address,
                        .count = span.count,
                        .rows = {span.row},
                        .silent_ns = 0,
                        .reply_ns = 0,
                        .worst_ns = 0});
  }
  return requests;
}

std::int64_t CharacterNs(const ModbusDeviceConfig& config, double characters) {
  const int parity_bits = config.parity == ModbusParity::kNone ? 0 : 1;
  const int bits = 1 + config.data_bits + parity_bits + config.stop_bits;
  return static_cast<std::int64_t>(
      std::ceil(characters * bits * static_cast<double>(kSecondNs) / config.baud));
}

void SetTimes(const ModbusDeviceConfig& config, std::vector<ModbusRequest>* requests) {
  const auto own_ns = static_cast<std::int64_t>(
      std::ceil(config.response_timeout_ms * static_cast<double>(kMillisecondNs)));
  for (ModbusRequest& request : *requests) {
    request.reply_ns = own_ns;
    if (config.transport == ModbusTransport::kRtu) {
      const int payload = HoldsBits(request.table) ? (request.count + 7) / 8 : 2 * request.count;
      request.silent_ns = config.baud > 19200 ? 1'750'000 : CharacterNs(config, 3.5);
      // Request: unit, function, address, count, checksum. Reply: unit, function, length, checksum.
      request.reply_ns += CharacterNs(config, 8.0 + 5.0 + payload) + request.silent_ns;
    }
    request.worst_ns = request.silent_ns + request.reply_ns + kOverheadNs;
  }
}

std::int64_t SumOfWorst(const std::vector<ModbusRequest>& requests) {
  return std::accumulate(requests.begin(), requests.end(), std::int64_t{0},
                         [](std::int64_t sum, const ModbusRequest& r) { return sum + r.worst_ns; });
}

}  // namespace

ModbusPlan PlanModbus(const ModbusDeviceConfig& config) {
  std::vector<Span> proofs, reads;
  for (std::size_t i = 0; i < config.identification.size(); ++i) {
    const ModbusIdentity& id = config.identification[i];
    proofs.push_back(
        {.table = id.table, .address = id.address, .count = 1, .row = static_cast<int>(i)});
  }
  for (std::size_t i = 0; i < config.map.size(); ++i) {
    const ModbusRegister& row = config.map[i];
    reads.push_back({.table = row.table,
                     .address = row.address,
                     .count = WidthOf(row.type),
                     .row = static_cast<int>(i)});
  }
  // The identity check reads no gaps: a device may reject addresses that it does not have, and the
  // order of its identification registers is arbitrary.
  ModbusPlan plan{.proofs = Group(std::move(proofs), 0),
                  .reads = Group(std::move(reads), config.gap_limit),
                  .exchange_worst_ns = 0,
                  .reconnect_worst_ns = 0};
  SetTimes(config, &plan.proofs);
  SetTimes(config, &plan.reads);
  plan.exchange_worst_ns = SumOfWorst(plan.reads);
  const bool rtu = config.transport == ModbusTransport::kRtu;
  if (rtu && !plan.proofs.empty()) plan.exchange_worst_ns += plan.proofs.front().worst_ns;
  const auto connect_ns = static_cast<std::int64_t>(
      std::ceil(config.response_timeout_ms * static_cast<double>(kMillisecondNs)));
  plan.reconnect_worst_ns = connect_ns + 2 * kOverheadNs + SumOfWorst(plan.proofs);
  return plan;
}

std::vector<ModbusChannelCost> ChannelCosts(const ModbusDeviceConfig& config) {
  const ModbusPlan plan = PlanModbus(config);
  std::vector<ModbusChannelCost> costs(config.map.size());
  for (std::size_t i = 0; i < plan.reads.size(); ++i) {
    for (const int row : plan.reads[i].rows) {
      const auto at = static_cast<std::size_t>(row);
      costs[at] = {.channel = ChannelName(config.map[at]),
                   .request = static_cast<int>(i),
                   .worst_ns = plan.reads[i].worst_ns};
    }
  }
  return costs;
}

}  // namespace flexarm
