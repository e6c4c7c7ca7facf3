#pragma once

#include <cstdint>
#include <string>

#include "hal/bus_device.h"
#include "hal/canopen/canopen_config.h"

namespace flexarm {

/// Latched fault of the device; it sends no torque until Reconnect has succeeded.
enum class CanopenFaultKind : std::uint8_t {
  kNone,
  kEmergency,       ///< code: the code of the emergency message
  kHeartbeatLost,   ///< no heartbeat within node_timeout_ms
  kNotOperational,  ///< code: the NMT state in the heartbeat
  kSilent,          ///< no answer to several SYNCs in a row
  kDriveFault,      ///< code: statusword; the drive is in fault
  kLeftOperation,   ///< code: statusword; an enabled drive has disabled itself
  kNotEnabled,      ///< code: statusword; it does not reach operation enabled
  kNotDisabled,     ///< code: statusword; it stays in operation after being switched off
  kSecondMaster,    ///< another node sends SYNC
  kTransmitStuck,   ///< frames are not sent: no node acknowledges, or the bus is overloaded
  kBusOff,          ///< the controller has left the bus
  kInterfaceDown,   ///< the interface was removed or is down
  kMalformed,       ///< a PDO with a wrong length or content
  kSetupRefused,    ///< code: object with a wrong value, or whose write is rejected
  kSetupSilent,     ///< code: object; no answer during the configuration
};

/// A fault and its node; node 0 is the bus.
struct CanopenFault {
  CanopenFaultKind kind = CanopenFaultKind::kNone;
  int node_id = 0;
  std::uint16_t code = 0;
};

/// Status that an exchange returns while the fault lasts. kNone: kTimeout.
BusStatus StatusOf(const CanopenConfig& config, const CanopenFault& fault) noexcept;

/// True if a node or the bus was lost: nodes may have lost their configuration.
bool NeedsConfiguration(CanopenFaultKind kind) noexcept;

/// Conversion to four bytes, and back.
BusFault Packed(const CanopenFault& fault) noexcept;
CanopenFault Unpacked(const BusFault& fault) noexcept;

/// "can0: node 1 (drive1): emergency message 0x2310". Text for the log; not real-time.
std::string CanopenFaultText(const CanopenConfig& config, const CanopenFault& fault);

}  // namespace flexarm
