// Runs Step with every law and estimator on the inputs of a whole run, and the other phases of the
// loop, for callgrind to count (tests/bench/step_cost.py). Prints how many steps it ran. The
// simulation that makes the inputs calls Step too; only calls within Counted are counted.

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/exchange/spsc_queue.h"
#include "controller/runlog/run_writer.h"
#include "controller/safety/torque_gate.h"
#include "controller/step/control_step.h"
#include "tests/bench/counted.h"
#include "tests/controller/loop/stack_run.h"
#include "tests/support/recorded_inputs.h"
#include "tests/support/step_variants.h"
#include "tests/support/study_planner.h"

namespace flexarm {

// Apart from its caller, so that callgrind sees it.
[[gnu::noinline]] bool PushRecord(SpscQueue<TickRecord>& queue, const TickRecord& record) {
  return queue.Push(record);
}

namespace {

// Every way through the gate: each state, torques within, at and beyond both limits, not finite,
// and old commands and permits.
void RunGate(const RigConfig& config) {
  const GateLimits limits = MakeGateLimits(config.safety, LoopGrid(config.loop));
  const double most_nm = limits.torque_nm[0];
  for (int state = 0; state < kSafetyStates; ++state) {
    for (const double asked_nm :
         {0.0, 1e-3, most_nm, -3.0 * most_nm, std::numeric_limits<double>::quiet_NaN()}) {
      for (const std::int64_t age_ns : {std::int64_t{0}, std::int64_t{-1}, INT64_MAX}) {
        GateResult result{};
        const GateInput in{.asked_nm = {asked_nm, -asked_nm},
                           .asked_age_ns = age_ns,
                           .permit = static_cast<SafetyState>(state),
                           .homing = state % 2 == 1,
                           .reduced = state % 3 == 1,
                           .permit_age_ns = age_ns,
                           .previous_nm = {0.0, 0.0},
                           .dt_s = 0.02};
        Counted([&] { result = Gate(in, limits); });
        if (!std::isfinite(result.torque_nm[0])) throw std::runtime_error("gate");
      }
    }
  }
}

// The recorder commits every 0.25 s: 12 or 13 samples.
constexpr std::int64_t kCommitEvery = 13;

// A record to the recorder's queue in the control thread, and to the log in the recorder's.
void RunRecords(const std::vector<TickRecord>& records) {
  SpscQueue<TickRecord> queue(records.size());
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("step-instructions-" + std::to_string(getpid()) + ".flexarm");
  {
    RunWriter writer(file, RunInfo{});
    for (const TickRecord& record : records) {
      bool fits = false;
      Counted([&] { fits = PushRecord(queue, record); });
      if (!fits) throw std::runtime_error("the queue is full");
      RunSink& log = writer;
      Counted([&] { log.Tick(record); });
      if (record.input.tick % kCommitEvery == 0) Counted([&] { log.Commit(); });
    }
  }
  std::filesystem::remove(file);
}

// 109 stages, the move of docs/theory/payload.md 5.5: a plan from rest, and one that continues it.
void RunPlans() {
  const std::vector<RigidPoint> path = StudyMove().Ahead(0);
  const PlanProblem problem{.first_tick = 0,
                            .x = PlanState::Zero(),
                            .payload_kg = 0.37,
                            .torque_before_nm = Eigen::Vector2d::Zero(),
                            .path = path,
                            .move_samples = static_cast<std::size_t>(StudyMove().periods)};
  const auto planner = std::make_unique<HorizonPlanner>(StudyPlanner());
  const auto cold = std::make_unique<HorizonPlan>(), warm = std::make_unique<HorizonPlan>();
  bool first = false, second = false;
  Counted([&] { first = planner->Plan(problem, nullptr, cold.get()); });
  Counted([&] { second = planner->Plan(problem, cold.get(), warm.get()); });
  if (!first || !second) {
    throw std::runtime_error("no plan");
  }
}

// Two seconds of the lock-step run of the default experiment, in the midst of its motion, with the
// plant of the shipped rig and with one of two modes a link.
void RunLockstep() {
  constexpr std::int64_t kSecond_ns = 1'000'000'000, kWarm_ns = 2 * kSecond_ns;
  for (const char* modes : {"sim.plant_modes=4", "sim.plant_modes=2"}) {
    StackRun run(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", {modes}),
                 LoadExperiment(FLEXARM_SOURCE_DIR "/config/experiments/square-30deg.toml"));
    run.Run(kWarm_ns);
    for (int second = 1; second <= 2; ++second) {
      Counted([&] { run.Run(kWarm_ns + second * kSecond_ns); });
    }
    if (run.permit().state != SafetyState::kRunning) throw std::runtime_error("no run");
  }
}

void CountAll() {
  const std::vector<StepInput> inputs =
      RecordedInputs(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"));
  RunGate(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"));
  RunPlans();
  RunLockstep();
  std::int64_t last = 0;
  const std::vector<StepVariant> variants = StepVariants();
  for (const StepVariant& variant : variants) {
    const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", variant.overrides);
    ControlStep step(config, DesignFor(config));
    std::vector<TickRecord> records;
    for (const StepInput& input : inputs) {
      TickRecord record{};
      record.input = input;
      Counted([&] { record.output = step.Step(input); });
      last = record.output.tick;
      records.push_back(record);
    }
    if (&variant == &variants.front()) RunRecords(records);
    std::printf("variant %s at most %d\n", variant.name, variant.most_instructions);
  }
  std::printf("steps %zu a variant, last tick %lld\n", inputs.size(), static_cast<long long>(last));
}

}  // namespace
}  // namespace flexarm

int main() {
  try {
    flexarm::CountAll();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "step_instructions: %s\n", error.what());
    return 1;
  }
}
