#pragma once

#include <cstdint>

#include "hal/bus_device.h"

namespace flexarm {

/// Faults of a board. Those marked "latched" last until Reconnect has succeeded.
enum class ComediFault : std::uint8_t {
  kNone,
  kStarting,       ///< the scan was restarted, and no scan has arrived yet
  kSlow,           ///< an instruction took longer than configured
  kReadRefused,    ///< the driver rejects reading a counter, an input or a line
  kLateScan,       ///< latched: the newest scan is older than the board's clock allows
  kEarlyScan,      ///< latched: scans arrive faster than the board reported
  kOverrun,        ///< latched: buffer overrun, or the board reports an error
  kScanStopped,    ///< latched: the board has stopped scanning
  kStartRefused,   ///< latched: the board does not start the scan
  kOutputRefused,  ///< latched: an output cannot be written
  kGone,           ///< latched until the daemon restarts: the board is gone
  kBeyondRange,    ///< latched: an input reads more than its converter can
};

/// Text of a fault for the log: "scan late".
const char* ToString(ComediFault fault) noexcept;

/// True for a latched fault: it lasts until Reconnect has succeeded.
bool Lasts(ComediFault fault) noexcept;

/// Status that an exchange returns for a fault.
BusStatus StatusOf(ComediFault fault) noexcept;

}  // namespace flexarm
