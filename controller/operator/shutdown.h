#pragma once

#include <cstdint>

#include "controller/types/messages.h"

namespace flexarm {

/// Brings the arm to a safe end: stops a run, then disarms, one request a state.
///
/// It is over once the arm is Idle, tripped or still starting, or kLimitNs after the beginning in
/// any state, and kSettleNs have passed since then. Real-time safe. Thread: operator.
class Shutdown {
 public:
  static constexpr std::int64_t kLimitNs = 6'000'000'000;  ///< a stop takes 3 s at most, or trips
  static constexpr std::int64_t kSettleNs = 300'000'000;   ///< the recorder takes the last records

  /// @param end_ns  when the daemon ends anyway, which then replaces the settling time;
  ///                INT64_MAX: it does not
  void Begin(std::int64_t now_ns, std::int64_t end_ns) noexcept;
  bool begun() const noexcept { return begun_ns_ != INT64_MAX; }

  /// Once a period after Begin.
  /// @returns the request to make now; kNone: none
  RequestKind Update(std::int64_t now_ns, SafetyState state) noexcept;

  bool over() const noexcept { return over_; }

 private:
  std::int64_t begun_ns_ = INT64_MAX;
  std::int64_t end_ns_ = INT64_MAX;
  SafetyState asked_in_ = SafetyState::kStarting;  // state of the newest request
  bool over_ = false;
};

}  // namespace flexarm
