#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "controller/step/control_step.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/step/step_at_rest.h"

namespace flexarm {

// A reference half a degree away, so that the torque is not zero.
inline StepInput Moving(std::int64_t tick, SafetyState state = SafetyState::kRunning) {
  StepInput input = AtRest(tick, state);
  input.reference_now.x_m[0] = input.reference_next.x_m[0] = 0.01;
  input.reference_now.x_m[1] = input.reference_next.x_m[1] = -0.01;
  return input;
}

// Plausible inputs of a run: counts, strains and torques that change from tick to tick.
inline std::vector<StepInput> ARun() {
  std::vector<StepInput> inputs;
  for (int k = 0; k < 60; ++k) {
    StepInput input = Moving(k, k < 40 ? SafetyState::kRunning : SafetyState::kStopping);
    const double angle = 30.0 * std::sin(0.05 * k);  // counts
    const auto counts = static_cast<std::int32_t>(std::lround(angle));
    for (std::size_t i = 0; i < 3; ++i) {
      input.frame.counter[i] = static_cast<std::uint32_t>(counts) & 0xFFu;
    }
    input.frame.counter[3] =
        static_cast<std::uint32_t>(std::lround(angle * 24480.0 / 2540.0)) & 0xFFFFu;
    input.applied_torque_nm = {std::sin(0.3 * k), 0.1 * std::cos(0.2 * k)};
    inputs.push_back(input);
  }
  inputs.front().reset = 1;
  return inputs;
}

class ControlStepTest : public testing::Test {
 protected:
  const RigConfig config_ = ShippedRig({kThesisLaw});
  ControlStep step_{config_, ShippedDesign()};
};

}  // namespace flexarm
