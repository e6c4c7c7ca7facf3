#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/types/records.h"

namespace flexarm {

/// What happened before a run and belongs to it: the experiment for which it was asked, and the
/// events since the arm was last disarmed (who armed it, with which overrides, warnings).
/// Not real-time safe. Thread: the recorder's.
class RunContext {
 public:
  /// So many events are kept, the first ones: the journal has them all.
  static constexpr std::size_t kMostEvents = 64;

  /// An event outside a run, or an announcement at any time.
  void Add(const RunEvent& event);
  /// The arm was disarmed: what is asked from now on is of another arming.
  void Clear() { events_.clear(); }

  /// The experiment that the request with this number asked for; an announcement without a number
  /// is of the next request. Empty: it was not announced.
  RunEvent Experiment(std::uint32_t request_number) const;
  const std::vector<RunEvent>& events() const { return events_; }

 private:
  std::vector<RunEvent> events_;
  RunEvent experiment_;                  // announced last
  std::uint32_t experiment_number_ = 0;  // of its request; 0: the next one
};

/// Whether an event announces an experiment, instead of telling what happened.
inline bool Announces(const RunEvent& event) { return event.kind == "experiment"; }

}  // namespace flexarm
