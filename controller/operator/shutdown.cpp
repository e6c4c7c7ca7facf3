#include "controller/operator/shutdown.h"

#include <cmath>

namespace flexarm {

std::int64_t Shutdown::LimitNs(const SafetyConfig& safety) {
  constexpr double kMargin_s = 1.0;
  return std::llround(1e9 * (safety.stop_timeout_s + kMargin_s));
}

void Shutdown::Begin(std::int64_t now_ns, std::int64_t end_ns) noexcept {
  begun_ns_ = now_ns;
  end_ns_ = end_ns;
}

void Shutdown::Update(std::int64_t now_ns, SafetyState state) noexcept {
  const bool late = now_ns - begun_ns_ > limit_ns_;
  if (RelayClosed(state) && !late) return;
  if (end_ns_ == INT64_MAX) end_ns_ = now_ns + kSettleNs;
  over_ = now_ns >= end_ns_;
}

}  // namespace flexarm
