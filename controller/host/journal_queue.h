#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace flexarm {

/// One line of the daemon's text log.
struct JournalLine {
  bool is_error;
  std::string text;
  std::chrono::system_clock::time_point at;  ///< when it was reported, not when it is written
};

/// Bounded queue of lines with a thread that writes them, so that a log that is not read (a stuck
/// pipe, Ctrl-S, journald) never delays who reports a line. A full queue drops lines; the first
/// line written after a gap is preceded by one that gives their number.
///
/// Not real-time safe: Push takes a lock, though never while a line is written. Thread: Push any
/// ordinary one, the rest one.
class JournalQueue {
 public:
  using Write = std::function<void(const JournalLine&)>;  ///< may block; no exception

  static constexpr std::size_t kDepth = 1'000;
  static constexpr std::chrono::milliseconds kFlushLimit{1'000};

  explicit JournalQueue(Write write, std::size_t depth = kDepth);
  /// Starts the thread if Start was not called, and waits until every line is written, kFlushLimit
  /// at most. A thread that still hangs in `write` is left behind: it owns what it uses.
  ~JournalQueue();
  JournalQueue(const JournalQueue&) = delete;
  JournalQueue& operator=(const JournalQueue&) = delete;

  /// Starts the thread, once; lines pushed before wait for it. The thread inherits the caller's
  /// signal mask.
  void Start();

  /// Never waits for a line to be written.
  void Push(JournalLine line);

 private:
  struct Shared;
  static void WriteAll(const std::shared_ptr<Shared>& shared);

  std::shared_ptr<Shared> shared_;
  bool started_ = false;
};

}  // namespace flexarm
