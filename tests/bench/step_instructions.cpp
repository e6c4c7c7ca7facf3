// Runs Step with every law and estimator on the inputs of a whole run, for callgrind to count
// (tests/bench/step_cost.py). Prints how many steps it ran. The simulation that makes the inputs
// calls Step too; only calls through CountedStep are counted.

#include <cstdint>
#include <cstdio>
#include <exception>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/step/control_step.h"
#include "tests/support/recorded_inputs.h"
#include "tests/support/step_variants.h"

namespace flexarm {

[[gnu::noinline]] StepOutput CountedStep(ControlStep& step, const StepInput& input) {
  return step.Step(input);
}

namespace {

void Run() {
  const std::vector<StepInput> inputs =
      RecordedInputs(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"));
  std::int64_t last = 0;
  for (const StepVariant& variant : StepVariants()) {
    const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", variant.overrides);
    ControlStep step(config, DesignFor(config));
    for (const StepInput& input : inputs) last = CountedStep(step, input).tick;
    std::printf("variant %s at most %d\n", variant.name, variant.most_instructions);
  }
  std::printf("steps %zu a variant, last tick %lld\n", inputs.size(), static_cast<long long>(last));
}

}  // namespace
}  // namespace flexarm

int main() {
  try {
    flexarm::Run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "step_instructions: %s\n", error.what());
    return 1;
  }
}
