#include "hal/modbus/modbus_config.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

#include "hal/line_names.h"
#include "hal/modbus/modbus_plan.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr int kAddresses = 65536;
// Baud rates that every kind of serial port supports.
constexpr std::array<int, 9> kBauds = {1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400};

bool IsAddress(int address) { return address >= 0 && address < kAddresses; }

void CheckTcp(const ModbusDeviceConfig& d, ProblemList* list) {
  in_addr address{};
  list->Require(inet_pton(AF_INET, d.host.c_str(), &address) == 1, "host", d.host,
                "must be an IPv4 address in digits: a name lookup has no time bound");
  list->Within("port", d.port, 1, 65535, "a TCP port; Modbus's own is 502");
  list->Require((d.unit >= 0 && d.unit <= 247) || d.unit == 255, "unit", NumberText(d.unit),
                "must lie in 0 .. 247, or be 255 (the TCP device itself)");
}

void CheckRtu(const ModbusDeviceConfig& d, ProblemList* list) {
  list->Require(d.device.starts_with('/'), "device", d.device,
                "must be the absolute path of a serial port, preferably in /dev/serial/by-id");
  list->Require(std::find(kBauds.begin(), kBauds.end(), d.baud) != kBauds.end(), "baud",
                NumberText(d.baud),
                "must be 1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200 or 230400");
  list->Require(d.data_bits == 8, "data_bits", NumberText(d.data_bits),
                "must be 8: a byte of a Modbus RTU frame has 8 bits");
  list->Within("stop_bits", d.stop_bits, 1, 2, "stop bits of a character");
  list->Within("unit", d.unit, 1, 247, "0 is the broadcast, which has no reply");
}

void CheckIdentification(const ModbusDeviceConfig& d, ProblemList* list) {
  list->Require(!d.identification.empty(), "identification", "0 rows",
                "must have a row: a register whose value identifies the device");
  std::set<std::pair<ModbusTable, int>> seen;
  for (std::size_t i = 0; i < d.identification.size(); ++i) {
    const ModbusIdentity& id = d.identification[i];
    const std::string key = ProblemList::Element("identification", i);
    list->Require(!HoldsBits(id.table), key + ".table", ToString(id.table),
                  "must be \"input register\" or \"holding register\"");
    list->Within(key + ".address", id.address, 0, kAddresses - 1, "the address on the wire");
    list->Within(key + ".expected", id.expected, 0, 65535, "a register has 16 bits");
    list->Require(seen.insert({id.table, id.address}).second, key + ".address",
                  NumberText(id.address), "must be named by one row only");
  }
}

// Largest count that the row can give; 0 for types without a bounded range.
double LargestCounts(const ModbusRegister& row) {
  const double value = row.type == ModbusType::kInt16    ? 32768.0
                       : row.type == ModbusType::kUint16 ? 65535.0
                                                         : 0.0;
  return std::abs(row.scale) * value + std::abs(row.offset_counts);
}

void CheckStrainRow(const ModbusRegister& r, const std::string& key, std::size_t strain_rows,
                    ProblemList* list) {
  list->Require(
      r.index >= 0 && static_cast<std::size_t>(r.index) < strain_rows, key + ".strain",
      NumberText(r.index),
      "must be a row of [[sensors.strain]], from 0; it has rows: " + NumberText(strain_rows));
  list->Require(!HoldsBits(r.table), key + ".table", ToString(r.table),
                "must be \"input register\" or \"holding register\": a strain is a number");
  list->Require(r.type != ModbusType::kBit, key + ".type", "bit",
                "must be int16, uint16, int32 or float32: a strain is a number");
  list->Require(std::isfinite(r.scale) && r.scale != 0.0, key + ".scale", NumberText(r.scale),
                "must be a number other than 0: counts per unit of the value");
  list->Require(std::isfinite(r.offset_counts), key + ".offset_counts", NumberText(r.offset_counts),
                "must be a number: counts at value 0");
  list->Require(!(LargestCounts(r) > 2147483647.0), key + ".scale", NumberText(r.scale),
                "must keep scale * value + offset within 32 bits");
}

void CheckInputRow(const ModbusRegister& r, const std::string& key, ProblemList* list) {
  list->Require(r.index >= 0 && r.index < kLines, key + ".input", NumberText(r.index),
                "must be the name of a digital input");
  list->Require(HoldsBits(r.table), key + ".table", ToString(r.table),
                "must be \"discrete input\" or \"coil\": an input is a bit");
  list->Require(r.type == ModbusType::kBit, key + ".type", "not a bit",
                "must be left out, or bit: an input is a bit");
}

// Two overlapping rows of a device: one of them has a wrong address.
void CheckOverlaps(const ModbusDeviceConfig& d, ProblemList* list) {
  std::map<std::pair<ModbusTable, int>, std::size_t> taken;
  for (std::size_t i = 0; i < d.map.size(); ++i) {
    const ModbusRegister& r = d.map[i];
    const std::string key = ProblemList::Element("register", i) + ".address";
    const int end = r.address + WidthOf(r.type);
    list->Require(IsAddress(r.address) && end <= kAddresses, key, NumberText(r.address),
                  "must lie in 0 .. 65535 with all of its registers");
    if (!IsAddress(r.address)) continue;
    for (int address = r.address; address < end; ++address) {
      const auto [place, fresh] = taken.insert({{r.table, address}, i});
      list->Require(fresh, key, NumberText(r.address),
                    "must not overlap " + ProblemList::Element("register", place->second) + " (" +
                        ChannelName(d.map[place->second]) + "): both take " + ToString(r.table) +
                        " " + NumberText(address));
    }
  }
}

// A late reply on a serial line has no transaction number. It is recognised because the request
// after a failure, an identity check, differs from every first request for readings.
void CheckResynchronisation(const ModbusDeviceConfig& d, const ModbusPlan& plan,
                            ProblemList* list) {
  if (d.transport != ModbusTransport::kRtu) return;
  for (const ModbusRequest& proof : plan.proofs) {
    const bool differs =
        std::none_of(plan.reads.begin(), plan.reads.end(), [&](const ModbusRequest& read) {
          return proof.table == read.table && proof.count == read.count;
        });
    list->Require(
        differs, "identification", NumberText(proof.count) + " x " + ToString(proof.table),
        "must differ in table or number from every request for readings, or a late reply "
        "on the serial line could be mistaken for another; name one register more or less");
  }
}

void CheckTime(const ModbusDeviceConfig& d, const ModbusPlan& plan, std::int64_t available_ns,
               ProblemList* list) {
  const auto milliseconds = [](std::int64_t ns) {
    return NumberText(std::round(static_cast<double>(ns) / 1e4) / 100.0) + " ms";
  };
  std::string costs;
  for (const ModbusRequest& read : plan.reads) {
    costs += "; ";
    for (const int i : read.rows) {
      costs += ChannelName(d.map[static_cast<std::size_t>(i)]) + " ";
    }
    costs += "together " + milliseconds(read.worst_ns);
  }
  list->Require(plan.exchange_worst_ns <= available_ns, "response_timeout_ms",
                NumberText(d.response_timeout_ms),
                "must leave an exchange within " + milliseconds(available_ns) + "; it may take " +
                    milliseconds(plan.exchange_worst_ns) + costs);
}

}  // namespace

const char* ToString(ModbusTable table) noexcept {
  switch (table) {
    case ModbusTable::kCoil:
      return "coil";
    case ModbusTable::kDiscreteInput:
      return "discrete input";
    case ModbusTable::kHoldingRegister:
      return "holding register";
    case ModbusTable::kInputRegister:
      return "input register";
  }
  return "?";
}

std::string ChannelName(const ModbusRegister& row) {
  if (row.role == ModbusRole::kStrain) {
    return "strain[" + NumberText(row.index) + "]";
  }
  if (row.index < 0 || row.index >= kLines) return "input " + NumberText(row.index);
  return ToString(static_cast<Line>(row.index));
}

std::vector<Problem> ModbusDeviceConfig::Problems(const std::string& section,
                                                  std::size_t strain_rows,
                                                  std::int64_t available_ns) const {
  ProblemList list(section);
  list.Require(!name.empty(), "name", name, "must not be empty: messages contain it");
  transport == ModbusTransport::kTcp ? CheckTcp(*this, &list) : CheckRtu(*this, &list);
  list.Within("response_timeout_ms", response_timeout_ms, 0.5, 1000.0,
              "largest response time of the device");
  list.Within("gap_limit", gap_limit, 0, 120,
              "unused addresses that may be read to save a request");
  CheckIdentification(*this, &list);
  list.Require(!map.empty(), "register", "0 rows", "must have at least one row");
  for (std::size_t i = 0; i < map.size(); ++i) {
    const std::string key = ProblemList::Element("register", i);
    map[i].role == ModbusRole::kStrain ? CheckStrainRow(map[i], key, strain_rows, &list)
                                       : CheckInputRow(map[i], key, &list);
  }
  CheckOverlaps(*this, &list);
  if (list.empty()) {  // requests and times are valid
    const ModbusPlan plan = PlanModbus(*this);
    CheckResynchronisation(*this, plan, &list);
    CheckTime(*this, plan, available_ns, &list);
  }
  return list.Take();
}

}  // namespace flexarm
