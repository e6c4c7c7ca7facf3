#include "controller/operator/shutdown.h"

namespace flexarm {

void Shutdown::Begin(std::int64_t now_ns, std::int64_t end_ns) noexcept {
  begun_ns_ = now_ns;
  end_ns_ = end_ns;
}

RequestKind Shutdown::Update(std::int64_t now_ns, SafetyState state) noexcept {
  const bool late = now_ns - begun_ns_ > kLimitNs;
  const bool moving = state == SafetyState::kRunning || state == SafetyState::kStopping;
  if (late || (!moving && state != SafetyState::kArmed)) {
    if (end_ns_ == INT64_MAX) end_ns_ = now_ns + kSettleNs;
    over_ = now_ns >= end_ns_;
    return RequestKind::kNone;
  }
  if (state == asked_in_) return RequestKind::kNone;
  asked_in_ = state;
  if (state == SafetyState::kRunning) return RequestKind::kStop;
  return state == SafetyState::kArmed ? RequestKind::kDisarm : RequestKind::kNone;
}

}  // namespace flexarm
