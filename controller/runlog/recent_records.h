#pragma once

#include <cstdint>
#include <deque>
#include <variant>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/run_sink.h"
#include "controller/types/records.h"

namespace flexarm {

inline constexpr std::int64_t kBeforeTripNs = 10'000'000'000;  ///< kept for a trip outside a run

/// The records of the last kBeforeTripNs, in order of time: a trip outside a run has no log that
/// shows how it came about. About 3 MB.
/// Not real-time safe. Thread: the recorder's.
class RecentRecords {
 public:
  // In order of time. Each forgets what has become too old.
  void Add(const TickRecord& record) { Add(record.input.now_ns, record); }
  void Add(const TimingRecord& record) { Add(record.due_ns, record); }
  void Add(const SafetyRecord& record) { Add(record.due_ns, record); }
  void Add(const RunEvent& event) { Add(event.time_ns, event); }

  bool empty() const { return entries_.empty(); }
  /// Of the oldest record; there must be one.
  std::int64_t oldest_ns() const { return entries_.front().time_ns; }

  /// Calls visit(record) for each, with its own type.
  template <typename Visit>
  void ForEach(const Visit& visit) const {
    for (const Entry& entry : entries_) std::visit(visit, entry.record);
  }

 private:
  struct Entry {
    std::int64_t time_ns;
    std::variant<TickRecord, TimingRecord, SafetyRecord, RunEvent> record;
  };

  template <typename Record>
  void Add(std::int64_t time_ns, const Record& record) {
    entries_.push_back({.time_ns = time_ns, .record = record});
    while (entries_.front().time_ns < time_ns - kBeforeTripNs) entries_.pop_front();
  }

  std::deque<Entry> entries_;
};

}  // namespace flexarm
