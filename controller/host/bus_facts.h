#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/host/host_files.h"
#include "hal/canopen/can_link.h"
#include "hal/wired/hal_config.h"

namespace flexarm {

/// A thread of the kernel that serves one interrupt.
struct InterruptThread {
  int number;        ///< of the interrupt
  std::string name;  ///< of its device: "can0", "xhci_hcd"
  int priority;      ///< SCHED_FIFO; 0: ordinary scheduling
};

/// The device of this machine that a bus of the rig is connected to.
struct BusFacts {
  enum class Kind : std::uint8_t { kCan, kNetwork, kSerial, kBoard };
  enum class Presence : std::uint8_t {
    kMissing,
    kVirtual,  ///< no hardware: vcan0, lo, a pseudo-terminal
    kDevice,
  };

  Kind kind;
  std::string bus;     ///< name of the bus: "can0", "strain-amplifier-1"
  std::string device;  ///< "can0", "eth1", "/dev/ttyUSB0", "/dev/comedi0"; "": no route to the host
  Presence presence;
  std::vector<int> interrupt;      ///< of the device, or of the nearest controller above it
  std::vector<std::string> names;  ///< under which its driver may have requested the interrupt
  std::optional<CanLink> link;     ///< CAN only; nothing: not readable
  HostText latency_timer_ms;       ///< serial only; absent: the adapter has none
};

/// One for each bus of the rig, in its order.
std::vector<BusFacts> ReadBusFacts(const HostFiles& files, const HalConfig& hal);

/// The threads of all interrupts.
std::vector<InterruptThread> ReadInterruptThreads(const HostFiles& files);

/// Those of `all` that serve the device of this bus.
std::vector<InterruptThread> ThreadsOf(const BusFacts& bus,
                                       const std::vector<InterruptThread>& all);

}  // namespace flexarm
