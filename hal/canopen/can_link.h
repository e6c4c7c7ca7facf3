#pragma once

#include <cstdint>
#include <string>

#include "hal/canopen/can_bus.h"

namespace flexarm {

/// What the kernel says of a CAN interface, over rtnetlink.
struct CanLink {
  bool up;
  bool controller;               ///< has a CAN controller: not a virtual interface
  int index;                     ///< of the interface
  std::uint32_t transmit_queue;  ///< frames, txqueuelen
  CanState state;                ///< of the controller; kActive of a virtual interface
  std::uint32_t bitrate_bps;     ///< 0 of a virtual interface
  std::uint32_t restart_ms;      ///< bus-off recovery by the kernel, 0: none
};

/// Asks the kernel; waits for whoever configures interfaces at the time. False, with errno, if
/// there is no such interface. Not on a cyclic path.
bool ReadCanLink(const std::string& interface, CanLink* link) noexcept;

/// Takes the interface down and up again: every queued frame is dropped, in the queue as in the
/// controller, and a controller that was bus-off starts anew. Needs CAP_NET_ADMIN. A driver may
/// take milliseconds. False, with errno, if the kernel refuses.
bool RestartCanLink(int index) noexcept;

}  // namespace flexarm
