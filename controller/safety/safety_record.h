#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "controller/safety/safety_machine.h"
#include "controller/types/messages.h"

namespace flexarm {

/// One change of the safety facts or state, as the recorder logs it and replay repeats it.
///
/// Between two records neither facts nor status changed and there was no request, so the records
/// with NextSafetyState(before, facts) == {after, refusal} describe the whole run.
struct SafetyRecord {
  std::int64_t due_ns;  ///< safety tick
  SafetyFacts facts;
  Evidence evidence;             ///< of `after.cause`, written when it latches; else zero
  std::uint32_t request_number;  ///< of facts.request
  SafetyStatus before;
  SafetyStatus after;
  Refusal refusal;
  std::array<std::uint8_t, 7> reserved;  ///< zero
};
static_assert(std::is_trivially_copyable_v<SafetyRecord>);
static_assert(sizeof(SafetyRecord) == 72, "no padding: the bytes are logged");

/// Whether a trip latches in it.
constexpr bool Trips(const SafetyRecord& record) noexcept {
  return CauseLatched(record.after.state) && !CauseLatched(record.before.state);
}

}  // namespace flexarm
