#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/host/bus_facts.h"
#include "controller/host/host_files.h"
#include "controller/realtime/realtime_setup.h"

namespace flexarm {

/// A sleep state of a processor that the kernel may choose.
struct IdleState {
  std::string name;                             ///< "C6"
  std::optional<std::int64_t> exit_latency_us;  ///< nothing: not readable
};

/// One processor that this process may use.
struct CpuFacts {
  int number;
  HostText governor;                ///< of its clock frequency; absent: it has one frequency
  std::vector<IdleState> may_idle;  ///< states that are not disabled
};

/// What the real-time behaviour of a machine depends on.
struct HostFacts {
  RealtimeHost realtime;
  std::optional<bool> may_lock_all;               ///< CAP_IPC_LOCK; nothing: not readable
  HostText throttle_period_us;                    ///< kernel.sched_rt_period_us
  std::optional<std::vector<CpuFacts>> cpu;       ///< nothing: not readable
  std::optional<std::int64_t> wake_up_limit_us;   ///< held by a process on /dev/cpu_dma_latency;
                                                  ///< nothing: none, or not readable
  HostText isolated_cpus;                         ///< list: "2-3"
  HostText clock_source;                          ///< "tsc"
  std::vector<InterruptThread> interrupt_thread;  ///< of every device
  std::vector<BusFacts> bus;                      ///< of the rig; empty without one
  std::string time_service;                       ///< process that sets the clock; "": none
  HostText chrony_config;
};

/// Reads the facts. Starts and joins one thread of `fifo_priority` to see whether it may; the
/// limits and permissions are those of this process.
HostFacts ReadHostFacts(const HostFiles& files, const HalConfig& hal, int fifo_priority);

}  // namespace flexarm
