#pragma once

#include <cstdint>
#include <string>

#include "hal/bus_device.h"
#include "hal/canopen/canopen_config.h"

namespace flexarm {

/// Why the device refuses torque. It stays until Reconnect has succeeded.
enum class CanopenFaultKind : std::uint8_t {
  kNone,
  kEmergency,       ///< code: that of the emergency message
  kHeartbeatLost,   ///< no heartbeat within node_timeout_ms
  kNotOperational,  ///< code: the NMT state that the heartbeat says
  kSilent,          ///< no answer to SYNC, several times in a row
  kDriveFault,      ///< code: statusword; the drive is in fault
  kLeftOperation,   ///< code: statusword; a drive that was enabled is not any more
  kNotEnabled,      ///< code: statusword; it does not follow the controlword to operation
  kNotDisabled,     ///< code: statusword; it stays in operation although it shall be off
  kSecondMaster,    ///< somebody else sends SYNC
  kTransmitStuck,   ///< frames do not go out: nobody acknowledges, or the bus is too busy
  kBusOff,          ///< the controller has left the bus
  kInterfaceDown,   ///< there is no interface any more
  kMalformed,       ///< a PDO of a length or content that it does not have
  kSetupRefused,    ///< code: object whose value is not what it must be, or is not taken
  kSetupSilent,     ///< code: object; no answer while it is configured anew
};

/// A fault, and of which node: 0 is the bus.
struct CanopenFault {
  CanopenFaultKind kind = CanopenFaultKind::kNone;
  int node_id = 0;
  std::uint16_t code = 0;
};

/// What an exchange returns while the fault lasts. kNone: kTimeout.
BusStatus StatusOf(const CanopenConfig& config, const CanopenFault& fault) noexcept;

/// A node, or the bus, was lost: its configuration may be gone with it.
bool NeedsConfiguration(CanopenFaultKind kind) noexcept;

/// As four bytes, and back.
BusFault Packed(const CanopenFault& fault) noexcept;
CanopenFault Unpacked(const BusFault& fault) noexcept;

/// "can0: node 1 (drive1): emergency message 0x2310". For the log, not real-time.
std::string CanopenFaultText(const CanopenConfig& config, const CanopenFault& fault);

}  // namespace flexarm
