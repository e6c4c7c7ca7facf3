#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "controller/operator/cause_json.h"
#include "controller/runlog/event_queue.h"
#include "controller/tasks/bus_health.h"
#include "controller/types/messages.h"

namespace flexarm {

/// Notes in the log what a trip came with and no record of the loop has, for its report: an event
/// "circumstances" when it latches (time of day; counts of all threads and buses, then and
/// kBefore_s before), and an event "causes" then and whenever the causes that are present change
/// (each with the value that breaks its limit).
/// Not real-time safe. Thread: operator.
class TripCircumstances {
 public:
  static constexpr int kBefore_s = 10;
  /// Events "causes" of one trip, at most: a loose contact must not fill the log.
  static constexpr int kMostChanges = 20;

  struct Sources {
    const SensorConfig* sensors;
    BusTextOf bus_text;                             ///< LoopStack::BusText
    std::function<nlohmann::json()> thread_status;  ///< OperatorContext::thread_status
  };

  /// @param events  to the recorder; outlives this, as do the sources
  TripCircumstances(Sources sources, EventQueue* events)
      : sources_(std::move(sources)), events_(events) {}

  /// Once a period, in order of time.
  void Follow(std::int64_t now_ns, const Permit& permit, const PresentCauses& present,
              const std::vector<BusHealth>& buses);

  /// Whether a trip of this safety tick is the one that is latched now, or came after it. Of no
  /// daemon's trip (INT64_MIN): if the arm has been tripped since the start.
  bool IsOfLatched(std::int64_t trip_ns) const {
    return latched_ && (trip_ns > not_latched_ns_ || not_latched_ns_ == INT64_MIN);
  }

 private:
  struct Counts {
    std::int64_t at_ns;
    nlohmann::json threads, buses;
  };

  void NoteTrip(std::int64_t now_ns, const std::vector<BusHealth>& buses);
  void NoteCauses(std::int64_t now_ns, const PresentCauses& present);

  Sources sources_;
  EventQueue* events_;
  std::deque<Counts> counts_;  // one a second, the oldest first
  bool latched_ = false;
  std::int64_t not_latched_ns_ = INT64_MIN;  // newest safety tick without a latched trip
  TripCauses noted_ = 0;                     // causes of the last event
  int changes_ = 0;                          // events of this trip
};

}  // namespace flexarm
