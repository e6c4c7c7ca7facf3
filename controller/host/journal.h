#pragma once

#include <string>

#include "controller/host/journal_queue.h"

namespace flexarm {

/// The daemon's text log: to the journal when stderr is connected to it, else to stderr. A thread
/// of its own writes the lines: a log that is blocked or closed never delays who reports one.
/// Not real-time safe. Thread: lines any ordinary one, the rest one.
class Journal {
 public:
  Journal();

  /// Starts to write; lines reported before are kept until then. Call once the memory of the
  /// process is prepared (PrepareRealtime) and the signals are blocked, which the thread inherits.
  void Start() { queue_.Start(); }

  void Info(const std::string& text) { Report(false, text); }
  void Error(const std::string& text) { Report(true, text); }
  void Report(bool is_error, const std::string& text);

 private:
  JournalQueue queue_;
};

}  // namespace flexarm
