#pragma once

#include <cstdint>
#include <string>

namespace flexarm {

/// What the daemon tells systemd, if systemd started it (Type=notify); otherwise nothing happens.
/// Not real-time safe. Thread: any one at a time.
class ServiceManager {
 public:
  ServiceManager();

  void Ready();
  void Stopping();
  /// Feeds the watchdog, if the unit has one, four times in its interval; and the status line
  /// when it has changed.
  void Alive(std::int64_t now_ns, const std::string& status);

 private:
  std::int64_t watchdog_ns_;  // interval; 0: none
  std::int64_t fed_ns_ = INT64_MIN;
  std::string status_;
};

}  // namespace flexarm
