#pragma once

#include <cstdint>
#include <string>

namespace flexarm {

/// Notifies systemd of the daemon's state if systemd started it (Type=notify); otherwise no effect.
/// Not real-time safe. Thread: any one at a time.
class ServiceManager {
 public:
  ServiceManager();

  void Ready();
  void Stopping();
  /// Resets the watchdog of the unit, if any, four times in its interval, and updates the status
  /// line when it has changed.
  void Alive(std::int64_t now_ns, const std::string& status);

 private:
  std::int64_t watchdog_ns_;  // interval; 0: none
  std::int64_t fed_ns_ = INT64_MIN;
  std::string status_;
};

}  // namespace flexarm
