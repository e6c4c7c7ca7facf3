#include "controller/host/service_manager.h"

#include <systemd/sd-daemon.h>

namespace flexarm {

ServiceManager::ServiceManager() {
  std::uint64_t interval_us = 0;
  const bool watched = sd_watchdog_enabled(0, &interval_us) > 0;
  watchdog_ns_ = watched ? static_cast<std::int64_t>(interval_us) * 1'000 : 0;
}

void ServiceManager::Ready() { sd_notify(0, "READY=1"); }

void ServiceManager::Stopping() { sd_notify(0, "STOPPING=1"); }

void ServiceManager::Alive(std::int64_t now_ns, const std::string& status) {
  if (status != status_) {
    status_ = status;
    sd_notify(0, ("STATUS=" + status).c_str());
  }
  if (watchdog_ns_ == 0 || (fed_ns_ != INT64_MIN && now_ns - fed_ns_ < watchdog_ns_ / 4)) return;
  fed_ns_ = now_ns;
  sd_notify(0, "WATCHDOG=1");
}

}  // namespace flexarm
