#pragma once

#include <array>
#include <csignal>
#include <cstddef>

namespace flexarm {

/// Signals of a program that has gone wrong: no code of it can be trusted to go on.
inline constexpr std::array kCrashSignals = {SIGILL, SIGTRAP, SIGABRT, SIGBUS,
                                             SIGFPE, SIGSEGV, SIGSYS};

/// While it lives, a crash of the process, in any of its threads, first takes the power away, then
/// writes one line to stderr, and then has the effect that it would have had: by default the
/// process ends. A kernel may leave the lines of a dead process as they were.
///
/// The handler runs on the AlternateStack of the thread, if it has one, and calls only what is
/// async-signal-safe. One at a time in a process.
class CrashHandler {
 public:
  /// What takes the power away: called in a signal handler, by any thread, more than once.
  struct PowerOff {
    void (*call)(void* context) noexcept;
    void* context;
  };

  explicit CrashHandler(const PowerOff& power_off);
  ~CrashHandler();  ///< restores the effects of before
  CrashHandler(const CrashHandler&) = delete;
  CrashHandler& operator=(const CrashHandler&) = delete;

 private:
  PowerOff power_off_;
};

}  // namespace flexarm
