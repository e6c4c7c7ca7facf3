#pragma once

#include <cstdint>
#include <vector>

#include "controller/runlog/event_queue.h"
#include "controller/tasks/bus_health.h"
#include "controller/types/safety_state.h"

namespace flexarm {

/// Puts the counters of all buses into the log of a run, as an event "counters": when the torque
/// ends, by a stop or by a trip, since the log is still open then.
/// Not real-time safe. Thread: operator.
class BusCounterRecord {
 public:
  /// @param events  to the recorder; outlives this
  explicit BusCounterRecord(EventQueue* events) : events_(events) {}

  /// Once a period, in order of time.
  void Follow(std::int64_t now_ns, SafetyState state, const std::vector<BusHealth>& buses);

 private:
  EventQueue* events_;
  bool torque_ = false;  // was allowed in the last period
};

}  // namespace flexarm
