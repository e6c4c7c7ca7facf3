#pragma once

#include <csignal>
#include <cstdint>

namespace flexarm {

/// Ignores the signals that say nothing to a daemon and would end it, or make it stand still, by
/// default. docs/safety.md lists the effect of every signal. For the whole process.
void IgnoreOtherSignals();

/// The signals that end the daemon in order. While it lives, they are blocked in the thread that
/// constructed it, and in every thread that this one starts, and wait for Await.
class EndSignals {
 public:
  /// The end of the terminal is one of them, unless nohup(1) asked to survive that.
  EndSignals();
  EndSignals(const EndSignals&) = delete;
  EndSignals& operator=(const EndSignals&) = delete;

  /// True if one of them has arrived or arrives within the time.
  bool Await(std::int64_t wait_ns) const;

 private:
  sigset_t signals_{};
};

}  // namespace flexarm
