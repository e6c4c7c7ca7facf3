#pragma once

#include <cstdint>

#include "controller/types/step_types.h"
#include "tests/support/loop_time.h"

namespace flexarm {

/// Input of a step of the shipped rig, at rest at zero: every counter and channel reads 0.
inline StepInput AtRest(std::int64_t tick, SafetyState state) {
  constexpr std::int64_t kPhaseNs = 10'000'000;
  StepInput input{};
  input.tick = tick;
  input.sampling_instant_ns = tick * kPeriodNs;
  input.now_ns = input.sampling_instant_ns + kPhaseNs;
  input.frame.sampled_at_ns = input.sampling_instant_ns;
  input.frame.counter_valid = 0b1111;
  input.frame.strain_valid = 0xFFFFF;
  input.frame.levels = kHealthyLevels;
  input.safety_state = state;
  return input;
}

}  // namespace flexarm
