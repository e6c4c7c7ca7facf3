#pragma once

#include <cstdint>

#include "controller/operator/journal_report.h"
#include "controller/runlog/event_queue.h"
#include "controller/types/messages.h"

namespace flexarm {

/// Warns of threads that were too late where that does not trip, because no metal moves: a line of
/// the journal and an event "warning" of the log, with the counts so far.
///
/// At most once in kEveryNs: on a computer without real time the counts rise all the time.
/// Not real-time safe. Thread: operator.
class TimingWarnings {
 public:
  static constexpr std::int64_t kEveryNs = 10'000'000'000;

  /// @param events  to the recorder; outlives this
  TimingWarnings(EventQueue* events, JournalReport report);

  /// Once a period, in order of time.
  void Follow(std::int64_t now_ns, const TimingCounts& counts);

 private:
  EventQueue* events_;
  JournalReport report_;
  TimingCounts told_{};
  std::int64_t told_at_ns_ = INT64_MIN;
};

}  // namespace flexarm
