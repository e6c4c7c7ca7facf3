#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/host/host_facts.h"

namespace flexarm {

/// One thing that the machine needs to run a real rig. What cannot be read is not ok; what the
/// hardware does not have is.
struct HostCheck {
  std::string name;  ///< "clock-source", "can-queue:can0"
  bool ok;
  bool advice;           ///< does not count for the verdict
  std::string value;     ///< as found; starts with "unknown" if it cannot be read
  std::string required;  ///< what is ok
  std::string remedy;    ///< "" if ok
};

/// HostCheck::value of what exists and cannot be read.
inline constexpr const char* kUnknownValue = "unknown: not readable";

/// Interrupt threads of the rig's buses: above the bus threads (70), so that a waiting bus gets its
/// answer, and below safety (90).
inline constexpr int kLowestInterruptPriority = 75;
inline constexpr int kHighestInterruptPriority = 85;

/// Longest time that a processor may take to leave an idle state: a quarter of what the safety
/// thread has for its lines (SafetyLines::kBudgetNs).
inline constexpr std::int64_t kIdleExitLimit_us = 50;

/// Least share of a second that the kernel must leave to real-time threads: its default. They sleep
/// for most of a period, and the limit keeps the machine usable if one does not.
inline constexpr double kLeastRealtimeShare = 0.95;

/// The machine: kernel, permissions, processors, clock.
std::vector<HostCheck> MachineChecks(const HostFacts& facts);

/// What the buses of the rig need of it.
std::vector<HostCheck> BusChecks(const HostFacts& facts);

/// All checks of these facts.
std::vector<HostCheck> HostChecks(const HostFacts& facts);

/// True if every check that is no advice is ok.
bool HostReady(const std::vector<HostCheck>& checks);

}  // namespace flexarm
