#include "controller/operator/loop_watch.h"

#include <string>
#include <utility>

namespace flexarm {

bool LoopWatch::Follow(const OperatorSnapshot& now, const JournalReport& report) {
  const std::int64_t oldest_ns = now.now_ns - kOldestNs;  // renewed_ns may be INT64_MIN
  const bool safety = now.permit.renewed_ns > oldest_ns;
  const bool control = now.tick.input.now_ns > oldest_ns;
  const bool was_alive = std::exchange(alive_, safety && control);
  if (began_ && alive_ != was_alive) {
    const std::string stopped = safety    ? "the control thread has"
                                : control ? "the safety thread has"
                                          : "the safety and control threads have";
    report(!alive_, alive_ ? "the watchdog is notified again"
                           : "the watchdog is not notified: " + stopped +
                                 " not run for 100 ms; systemd ends the daemon if this lasts");
  }
  began_ = began_ || alive_;
  return alive_;
}

}  // namespace flexarm
