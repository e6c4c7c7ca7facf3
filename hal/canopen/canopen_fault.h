#pragma once

#include <cstdint>
#include <string>

#include "hal/bus_device.h"
#include "hal/canopen/canopen_config.h"

namespace flexarm {

/// Latched fault of the device; it sends no torque while it lasts. Values are logged: append only.
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
  kNoSupply,        ///< code: of its emergency; switched on, a drive gets no supply
  kSupplyOff,       ///< the same while it is off: no fault, never latched (SupplyEmergency)
};

/// A fault and its node; node 0 is the bus.
struct CanopenFault {
  CanopenFaultKind kind = CanopenFaultKind::kNone;
  int node_id = 0;
  std::uint16_t code = 0;
};

/// Status that an exchange returns while the fault lasts. kNone: kTimeout.
BusStatus StatusOf(const CanopenConfig& config, const CanopenFault& fault) noexcept;

/// True for a fault of a drive that is still there: it stays until the operator acknowledges it.
/// False: a node or the bus was lost, or an encoder has failed; the nodes are configured again.
bool NeedsAcknowledgement(const CanopenConfig& config, const CanopenFault& fault) noexcept;

/// True for an emergency code that a drive sends when its supply or its safe torque off falls away:
/// mains (31xx, but not 311x, too high), intermediate circuit too low (322x), and the device's own
/// codes (FFxx), as which safe torque off is reported. While the power is off the open relay
/// explains it.
constexpr bool SupplyEmergency(std::uint16_t code) noexcept {
  const unsigned group = code >> 4U;
  return ((group & 0xFF0U) == 0x310U && group != 0x311U) || group == 0x322U ||
         (group & 0xFF0U) == 0xFF0U;
}

/// Conversion to four bytes, and back.
BusFault Packed(const CanopenFault& fault) noexcept;
CanopenFault Unpacked(const BusFault& fault) noexcept;

/// "can0: node 1 (drive1): emergency message 0x2310". Text for the log; not real-time.
std::string CanopenFaultText(const CanopenConfig& config, const CanopenFault& fault);

}  // namespace flexarm
