#pragma once

#include <array>
#include <cstdint>

#include "controller/types/step_types.h"

namespace flexarm {

/// How a doubt is told.
struct PayloadWarning {
  PayloadDoubt doubt;
  const char* name;
  const char* text;
};

inline constexpr std::array<PayloadWarning, 3> kPayloadWarnings = {{
    {kPayloadAtBound, "payload-at-bound",
     "the payload found is as heavy as estimator.payload.max_kg allows: take load off, or raise "
     "it"},
    {kPayloadModelMismatch, "payload-model-mismatch",
     "the sensors contradict the arm's model, so the gains are those for a payload in doubt: was "
     "the load dropped or picked up in mid-move, or does the arm touch something?"},
    {kPayloadNotFound, "payload-not-found",
     "a move has ended and the payload is known no better than before it, so the gains are those "
     "for a payload in doubt: a longer or faster move shows more"},
}};

/// What is doubtful about the payload that is found: what the operator is told, once a run each.
class PayloadWatch {
 public:
  /// Every step, in order.
  /// @returns PayloadDoubt bits that are new in this run
  std::uint32_t Take(const StepInput& input, const StepOutput& output) noexcept {
    const bool runs = input.safety_state == SafetyState::kRunning;
    if (runs && !runs_) told_ = 0;
    runs_ = runs;
    if (!runs) return 0;
    const std::uint32_t news = output.payload_doubts & ~told_;
    told_ |= news;
    return news;
  }

 private:
  bool runs_ = false;
  std::uint32_t told_ = 0;
};

}  // namespace flexarm
