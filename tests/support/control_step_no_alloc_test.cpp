// The control step on the inputs of a whole run, and on every fault, without any heap use.

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/law/design.h"
#include "controller/step/control_step.h"
#include "tests/support/no_alloc.h"
#include "tests/support/recorded_inputs.h"
#include "tests/support/step_variants.h"

namespace flexarm {
namespace {

static_assert(noexcept(std::declval<ControlStep&>().Step(std::declval<const StepInput&>())));

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Case {
  const char* name;
  void (*change)(StepInput&);
};

// Faults of an input, besides the states.
constexpr Case kCases[] = {
    {"as recorded", [](StepInput&) {}},
    {"reset every tick", [](StepInput& in) { in.reset = 1; }},
    {"no counter", [](StepInput& in) { in.frame.counter_valid = 0; }},
    {"one counter", [](StepInput& in) { in.frame.counter_valid = 1; }},
    {"no strain", [](StepInput& in) { in.frame.strain_valid = 0; }},
    {"one strain channel a link", [](StepInput& in) { in.frame.strain_valid = 0x401; }},
    {"stale frame", [](StepInput& in) { in.frame.sampled_at_ns -= 60'000'000; }},
    {"jumping counter", [](StepInput& in) { in.frame.counter[0] ^= 0x40; }},
    {"saturated strain", [](StepInput& in) { in.frame.strain.fill(2047); }},
    {"applied torque not finite", [](StepInput& in) { in.applied_torque_nm = {kNaN, kNaN}; }},
    {"reference not finite", [](StepInput& in) { in.reference_next.x_m.fill(kNaN); }},
    {"reference far away", [](StepInput& in) { in.reference_next.u_m_nm = {1e3, -1e3}; }},
    {"experiment ended", [](StepInput& in) { in.reference_ended = 1; }},
};

TEST(ControlStepNoAlloc, HoldsOverTenThousandSamplesInEveryStateAndEveryFault) {
  if (!kNoAllocWorks) GTEST_SKIP() << "the sanitizer has its own allocator";
  const std::vector<StepInput> recorded =
      RecordedInputs(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"));
  for (const StepVariant& variant : StepVariants()) {
    SCOPED_TRACE(variant.name);
    const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", variant.overrides);
    const Design design = DesignFor(config);
    ControlStep step(config, design);

    std::int64_t samples = 0;
    for (const Case& wrong : kCases) {
      SCOPED_TRACE(wrong.name);
      for (int state = -1; state <= static_cast<int>(SafetyState::kTripped); ++state) {
        for (StepInput input : recorded) {
          if (state >= 0) input.safety_state = static_cast<SafetyState>(state);
          wrong.change(input);
          const NoAlloc armed;  // aborts, naming the function, when Step touches the heap
          const StepOutput output = step.Step(input);
          samples += output.tick == input.tick ? 1 : 0;
        }
      }
    }
    EXPECT_GE(samples, 10'000);
  }
}

}  // namespace
}  // namespace flexarm
