#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/sensor_frame.h"
#include "model/problem.h"

namespace flexarm {

/// What carries the requests.
enum class ModbusTransport : std::uint8_t { kTcp, kRtu };

/// The four tables of a Modbus device; the value is the function code that reads it.
enum class ModbusTable : std::uint8_t {
  kCoil = 1,
  kDiscreteInput = 2,
  kHoldingRegister = 3,
  kInputRegister = 4,
};

/// How a value lies in its registers.
enum class ModbusType : std::uint8_t { kBit, kInt16, kUint16, kInt32, kFloat32 };

/// Which register of a 32-bit value has the lower address. Bytes in a register: high byte first.
enum class ModbusWordOrder : std::uint8_t {
  kBig,     ///< the more significant one
  kLittle,  ///< the less significant one
};

enum class ModbusParity : std::uint8_t { kNone, kEven, kOdd };

/// What a row of the register map is to the rig.
enum class ModbusRole : std::uint8_t {
  kStrain,  ///< a strain channel; index: row of [[sensors.strain]], from 0
  kInput,   ///< a digital input, a second reading of the Line `index` once a period: see Either
};

/// One reading: [[hal.modbus.register]].
///
/// Strain: counts = round(scale * value + offset_counts), what the channel's converter would show.
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

/// A register whose value proves which device this is, or that it is set up as the rig needs it:
/// [[hal.modbus.identification]].
struct ModbusIdentity {
  ModbusTable table;  ///< kHoldingRegister or kInputRegister
  int address;
  int expected;  ///< 0 .. 65535
};

/// One Modbus server with one unit: [[hal.modbus]]. It has a connection and a thread of its own.
struct ModbusDeviceConfig {
  std::string name;  ///< in messages: "strain-amplifier-1"
  ModbusTransport transport;
  std::string host;    ///< TCP: IPv4 address in digits: looking a name up has no time bound
  int port;            ///< TCP: 1 .. 65535
  std::string device;  ///< RTU: "/dev/serial/by-id/.."
  int baud;            ///< RTU: 1/s
  ModbusParity parity;
  int data_bits;               ///< RTU: 8
  int stop_bits;               ///< RTU: 1 or 2
  int unit;                    ///< 1 .. 247; TCP also 0 and 255
  double response_timeout_ms;  ///< the device's own time; the wire's is added for RTU
  int gap_limit;               ///< addresses that may be read in vain to spare a request
  std::vector<ModbusIdentity> identification;
  std::vector<ModbusRegister> map;
};

/// All Modbus devices of the rig.
struct ModbusConfig {
  std::vector<ModbusDeviceConfig> device;

  /// Broken rules.
  /// @param strain_rows   rows of [[sensors.strain]]
  /// @param available_ns  in which one exchange must be over, whatever the peer does
  std::vector<Problem> Problems(std::size_t strain_rows, std::int64_t available_ns) const;
};

/// Registers (or bits) that a value of this type takes.
constexpr int WidthOf(ModbusType type) {
  return type == ModbusType::kInt32 || type == ModbusType::kFloat32 ? 2 : 1;
}

constexpr bool HoldsBits(ModbusTable table) {
  return table == ModbusTable::kCoil || table == ModbusTable::kDiscreteInput;
}

/// "input register", as in messages.
const char* Name(ModbusTable table) noexcept;

/// "strain[3]" or the name of the line.
std::string ChannelName(const ModbusRegister& row);

}  // namespace flexarm
