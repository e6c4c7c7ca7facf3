#pragma once

#include <cstdint>
#include <string>

#include "controller/operator/journal_report.h"
#include "controller/runlog/event_queue.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// Writes every change of the safety state to the journal, and the cause of a trip. A trip that a
/// bus caused also becomes an event "bus" of the log, with the device and node that failed.
///
/// Not real-time safe. Thread: operator.
class StateJournal {
 public:
  /// All pointers outlive the journal.
  StateJournal(const LoopStack* stack, const SensorConfig* sensors, EventQueue* events,
               JournalReport report);

  /// Once a period, in order of time. The state before the first call is Starting.
  void Follow(std::int64_t now_ns, const Permit& permit);

 private:
  std::string TripText(const Permit& permit, const std::string& of_bus) const;

  const LoopStack* stack_;
  const SensorConfig* sensors_;
  EventQueue* events_;
  JournalReport report_;
  SafetyState state_ = SafetyState::kStarting;
};

}  // namespace flexarm
