#pragma once

#include <cstdint>

#include "hal/bus_device.h"

namespace flexarm {

/// What went wrong with a board. Those that say so last until Reconnect has succeeded.
enum class ComediFault : std::uint8_t {
  kNone,
  kStarting,       ///< the scan has been started anew, and nothing has come yet
  kSlow,           ///< an instruction took longer than the config says
  kReadRefused,    ///< the driver refuses to read a counter, an input or a line
  kLateScan,       ///< lasts: the newest scan is older than the board's clock allows
  kEarlyScan,      ///< lasts: scans come faster than the board said
  kOverrun,        ///< lasts: the board's buffer ran over, or the board reports an error
  kScanStopped,    ///< lasts: the board has stopped scanning
  kStartRefused,   ///< lasts: the board does not start to scan
  kOutputRefused,  ///< lasts: an output cannot be written
  kGone,           ///< lasts, until the daemon starts anew: there is no board any more
};

/// "scan late", for the log.
const char* Name(ComediFault fault) noexcept;

/// It stays until Reconnect has succeeded.
bool Lasts(ComediFault fault) noexcept;

/// What an exchange returns.
BusStatus StatusOf(ComediFault fault) noexcept;

}  // namespace flexarm
