#pragma once

#include <cstdint>
#include <string>

#include "hal/canopen/can_bus.h"

namespace flexarm {

/// Properties of a CAN interface as the kernel reports them over rtnetlink.
struct CanLink {
  bool up;
  bool echo;                     ///< the driver echoes a frame when it was sent, not before
  bool controller;               ///< has a CAN controller: not a virtual interface
  int index;                     ///< of the interface
  std::uint32_t transmit_queue;  ///< frames, txqueuelen
  CanState state;                ///< of the controller; kActive of a virtual interface
  std::uint32_t bitrate_bps;     ///< 0 of a virtual interface
  std::uint32_t restart_ms;      ///< bus-off recovery by the kernel, 0: none
};

/// Queries the kernel; may wait for other processes that configure interfaces. False, with errno,
/// if there is no such interface. Not on a cyclic path.
bool ReadCanLink(const std::string& interface, CanLink* link) noexcept;

/// Takes the interface down and up again: every queued frame is dropped, in the queue and in the
/// controller, and a controller in bus-off restarts. Needs CAP_NET_ADMIN. A driver may take
/// milliseconds. False, with errno, if the kernel rejects the request.
bool RestartCanLink(int index) noexcept;

}  // namespace flexarm
