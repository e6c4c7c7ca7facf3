#pragma once

#include <cstdint>

#include "controller/types/messages.h"
#include "controller/types/trip_cause.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// Judges whether the relay does what it is told, by its mirror contact: the cause `safety-lines`.
///
/// The contact must follow a command within `kFollowNs`: a contactor takes 10 to 50 ms. A relay
/// that is welded, or whose mirror contact has lost its wire, counts as closed; one that does not
/// pull in, as open. Without a contact nothing is known and nothing is judged.
/// Pure, without a clock. Real-time: safe.
class RelayContactMonitor {
 public:
  static constexpr std::int64_t kFollowNs = 100'000'000;

  /// Once per tick. @param told_closed  the relay's command until this tick
  /// @returns true while the contact contradicts the command for too long
  constexpr bool Judge(std::int64_t due_ns, bool told_closed, RelayContact contact) noexcept {
    agrees_ = contact == RelayContact::kNone || (contact == RelayContact::kClosed) == told_closed;
    if (agrees_ || agreed_ns_ == INT64_MIN) agreed_ns_ = due_ns;
    contradicts_ns_ = due_ns - agreed_ns_;
    told_closed_ = told_closed;
    return contradicts_ns_ > kFollowNs;
  }

  /// Of the last tick: the contact says what the relay was told, or there is none.
  constexpr bool agrees() const noexcept { return agrees_; }

  /// Of the last tick: how long the contact has contradicted the command, and kFollowNs, in s.
  constexpr Evidence evidence() const noexcept {
    return {.value = static_cast<double>(contradicts_ns_) * 1e-9,
            .limit = static_cast<double>(kFollowNs) * 1e-9,
            .channel = static_cast<std::uint32_t>(told_closed_ ? LineTrouble::kRelayStuckOpen
                                                               : LineTrouble::kRelayStuckClosed),
            .detail = 0};
  }

 private:
  std::int64_t agreed_ns_ = INT64_MIN;  // the last tick in which it agreed; INT64_MIN: no tick yet
  std::int64_t contradicts_ns_ = 0;
  bool agrees_ = true;
  bool told_closed_ = false;
};

}  // namespace flexarm
