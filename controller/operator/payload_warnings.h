#pragma once

#include <array>
#include <cstdint>

#include "controller/types/step_types.h"
#include "estimator/payload_knowledge.h"

namespace flexarm {

/// A warning about the payload: its name in events and status, and its text.
struct PayloadWarningText {
  PayloadWarningBit bit;
  const char* name;
  const char* text;
};

inline constexpr std::array<PayloadWarningText, 3> kPayloadWarnings = {{
    {kPayloadAtBound, "payload-at-bound",
     "the payload estimate is at estimator.payload.max_kg: take load off, or raise that key"},
    {kPayloadModelMismatch, "payload-model-mismatch",
     "the sensors contradict the arm's model, so the law uses gains that are stable with every "
     "payload: check whether the load was dropped or picked up during the move, and whether the "
     "arm touches something"},
    {kPayloadNotObservable, "payload-not-observable",
     "a move has ended and the payload estimate is still uncertain, so the law uses gains that are "
     "stable with every payload: make a longer or a faster move"},
}};

/// Which warnings about the payload are new: each is reported once a run. Real-time safe.
/// Thread: operator.
class PayloadWarnings {
 public:
  /// Every step, in order.
  /// @returns PayloadWarningBits that are new in this run
  std::uint32_t Take(const StepInput& input, const StepOutput& output) noexcept {
    const bool runs = input.safety_state == SafetyState::kRunning;
    if (runs && !runs_) reported_ = 0;
    runs_ = runs;
    if (!runs) return 0;
    const std::uint32_t news = output.payload_warnings & ~reported_;
    reported_ |= news;
    return news;
  }

 private:
  bool runs_ = false;
  std::uint32_t reported_ = 0;
};

}  // namespace flexarm
