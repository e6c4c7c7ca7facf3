// Duration of a control step, and speed of all tasks together on the simulated arm.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

#include "controller/design/design_controller.h"
#include "controller/design/run_design.h"
#include "controller/law/design.h"
#include "controller/step/control_step.h"
#include "tests/support/recorded_inputs.h"
#include "tests/support/step_variants.h"

namespace flexarm {
namespace {

using Clock = std::chrono::steady_clock;

RigConfig Rig() { return LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"); }

double MicrosecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

// Each call is timed separately, because the slowest matters, not the mean. The counters include
// the reading of the clock, about 20 ns.
void Step(benchmark::State& state) {
  const StepVariant variant = StepVariants()[static_cast<std::size_t>(state.range(0))];
  state.SetLabel(variant.name);
  const std::vector<StepInput> inputs = RecordedInputs(Rig());
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", variant.overrides);
  ControlStep step(config, DesignFor(config));
  std::vector<double> taken_us;
  taken_us.reserve(10'000'000);
  std::size_t next = 0;
  for (auto _ : state) {
    const Clock::time_point start = Clock::now();
    benchmark::DoNotOptimize(step.Step(inputs[next]));
    taken_us.push_back(MicrosecondsSince(start));
    next = (next + 1) % inputs.size();
  }
  std::sort(taken_us.begin(), taken_us.end());
  const auto quantile = [&taken_us](double q) {
    return taken_us[static_cast<std::size_t>(q * static_cast<double>(taken_us.size() - 1))];
  };
  state.counters["p50_us"] = quantile(0.5);
  state.counters["p99.9_us"] = quantile(0.999);
  state.counters["max_us"] = taken_us.back();
}
BENCHMARK(Step)
    ->DenseRange(0, static_cast<int>(StepVariants().size()) - 1)
    ->Unit(benchmark::kMicrosecond)
    ->MinTime(0.5);

void Design(benchmark::State& state) {
  const RigConfig config = Rig();
  for (auto _ : state) benchmark::DoNotOptimize(DesignController(config).K.data());
}
BENCHMARK(Design)->Unit(benchmark::kMillisecond);

// All tasks in lock step, without design and start-up as in realtime_factor, for each number of
// plant modes a link.
void SimulatedRun(benchmark::State& state) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml",
                                      {"sim.plant_modes=" + std::to_string(state.range(0))});
  const Experiment experiment =
      LoadExperiment(FLEXARM_SOURCE_DIR "/config/experiments/square-30deg.toml");
  std::vector<double> factors;
  for (auto _ : state) {
    const SimulationResult result =
        Simulate({.config = config, .experiment = experiment, .payload_kg = {}, .log = {}});
    factors.push_back(result.realtime_factor);
    state.SetIterationTime(1.0 / result.realtime_factor);
  }
  std::sort(factors.begin(), factors.end());
  state.counters["realtime_factor"] = factors[factors.size() / 2];
}
// The time shown is that of one simulated second.
BENCHMARK(SimulatedRun)
    ->ArgName("modes")
    ->Arg(2)
    ->Arg(4)
    ->Arg(6)
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace flexarm
