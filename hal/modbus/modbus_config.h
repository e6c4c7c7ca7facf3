#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/sensor_frame.h"
#include "model/problem.h"

namespace flexarm {

/// Transport of the requests.
enum class ModbusTransport : std::uint8_t { kTcp, kRtu };

/// The four tables of a Modbus device; the value is the function code that reads it.
enum class ModbusTable : std::uint8_t {
  kCoil = 1,
  kDiscreteInput = 2,
  kHoldingRegister = 3,
  kInputRegister = 4,
};

/// Encoding of a value in its registers.
enum class ModbusType : std::uint8_t { kBit, kInt16, kUint16, kInt32, kFloat32 };

/// Which register of a 32-bit value has the lower address. Bytes in a register: high byte first.
enum class ModbusWordOrder : std::uint8_t {
  kBig,     ///< the more significant one
  kLittle,  ///< the less significant one
};

enum class ModbusParity : std::uint8_t { kNone, kEven, kOdd };

/// Meaning of a row of the register map.
enum class ModbusRole : std::uint8_t {
  kStrain,  ///< a strain channel; index: row of [[sensors.strain]], from 0
  kInput,   ///< a digital input: redundant reading of the Line `index`, once per period
};

/// One reading: [[hal.modbus.register]].
///
/// Strain: counts = round(scale * value + offset_counts), equal to the converter's counts.
struct ModbusRegister {
  ModbusRole role;
  int index;                   ///< see ModbusRole
  ModbusTable table;           ///< a strain needs registers, an input coils or discrete inputs
  int address;                 ///< as on the wire, 0 .. 65535 (not 30001-style numbers)
  ModbusType type;             ///< kBit for inputs
  ModbusWordOrder word_order;  ///< of 32-bit types
  double scale;                ///< counts per unit of the value
  double offset_counts;        ///< counts at value 0
};

/// A register whose value identifies the device or verifies its settings:
/// [[hal.modbus.identification]].
struct ModbusIdentity {
  ModbusTable table;  ///< kHoldingRegister or kInputRegister
  int address;
  int expected;  ///< 0 .. 65535
};

/// One Modbus server with one unit: [[hal.modbus]]. It has its own connection and thread.
struct ModbusDeviceConfig {
  std::string name;  ///< in messages: "strain-amplifier-1"
  ModbusTransport transport;
  std::string host;    ///< TCP: IPv4 address in digits: a name lookup has no time bound
  int port;            ///< TCP: 1 .. 65535
  std::string device;  ///< RTU: "/dev/serial/by-id/.."
  int baud;            ///< RTU: 1/s
  ModbusParity parity;
  int data_bits;               ///< RTU: 8
  int stop_bits;               ///< RTU: 1 or 2
  int unit;                    ///< 1 .. 247; TCP also 0 and 255
  double response_timeout_ms;  ///< the device's own time; the wire's is added for RTU
  int gap_limit;               ///< unused addresses that may be read to save a request
  std::vector<ModbusIdentity> identification;
  std::vector<ModbusRegister> map;

  /// Violated rules. `section` is the prefix of every key, e.g. "hal.modbus[0].".
  /// @param strain_rows   rows of [[sensors.strain]]
  /// @param available_ns  bound of one exchange, for any behaviour of the peer
  std::vector<Problem> Problems(const std::string& section, std::size_t strain_rows,
                                std::int64_t available_ns) const;
};

/// Number of registers (or bits) of a value of this type.
constexpr int WidthOf(ModbusType type) {
  return type == ModbusType::kInt32 || type == ModbusType::kFloat32 ? 2 : 1;
}

constexpr bool HoldsBits(ModbusTable table) {
  return table == ModbusTable::kCoil || table == ModbusTable::kDiscreteInput;
}

/// Name of a table in messages: "input register".
const char* ToString(ModbusTable table) noexcept;

/// "strain[3]" or the name of the line.
std::string ChannelName(const ModbusRegister& row);

}  // namespace flexarm
