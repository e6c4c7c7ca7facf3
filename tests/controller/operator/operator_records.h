#pragma once

#include <string>
#include <utility>
#include <vector>

#include "controller/operator/journal_report.h"
#include "controller/runlog/event_queue.h"

namespace flexarm {

/// A journal in memory.
class RecordedJournal {
 public:
  using Line = std::pair<bool, std::string>;  // is_error, text

  JournalReport Report() {
    return [this](bool is_error, const std::string& text) { lines.emplace_back(is_error, text); };
  }

  /// The place of the first line that holds `part`; -1: there is none.
  int Find(const std::string& part) const {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (lines[i].second.find(part) != std::string::npos) return static_cast<int>(i);
    }
    return -1;
  }

  std::vector<Line> lines;
};

/// The events that came since the last call.
inline std::vector<RunEvent> TakeEvents(EventQueue* queue) {
  std::vector<RunEvent> events;
  for (RunEvent event; queue->Pop(&event);) events.push_back(event);
  return events;
}

}  // namespace flexarm
