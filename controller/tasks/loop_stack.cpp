#include "controller/tasks/loop_stack.h"

#include <algorithm>

namespace flexarm {
namespace {

// 60 s of records: no loss if the recorder is blocked for that long. Of steps, 80 s at 50 Hz, and
// 10 s at rates from 400 Hz: a record has 2 KiB, all of it locked in memory.
constexpr std::size_t kTickDepth = 4'000;
constexpr std::size_t kSafetyDepth = 60'000;
constexpr std::size_t kOperatorDepth = 64;
constexpr std::size_t kOperatorTickDepth = 500;

// Of steps: 10 s, so that commissioning gets all and the recorder survives that; `least` or more.
std::size_t Depth(const RigConfig& config, std::size_t least) {
  constexpr std::int64_t kKeptNs = 10'000'000'000;
  return std::max(least, static_cast<std::size_t>(kKeptNs / config.loop.period_ns()));
}

std::vector<PermitChannel*> Joined(std::vector<PermitChannel*> first,
                                   const std::vector<PermitChannel*>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

std::unique_ptr<PlannerTask> PlannerOf(const RigConfig& config, const Design& design) {
  if (!PlansAhead(config.controller.kind)) return nullptr;
  return std::make_unique<PlannerTask>(config, design);
}

std::unique_ptr<PlanFollower> FollowerOf(const RigConfig& config, PlannerTask* planner) {
  if (planner == nullptr) return nullptr;
  return std::make_unique<PlanFollower>(PlanScheduleOf(config), &planner->requests(),
                                        &planner->plans());
}

// A rig without relay has no witness of it.
std::optional<DriveVoltageTimes> VoltageOf(const RigConfig& config) {
  return config.hal.gpiod ? config.hal.gpiod->drive_voltage : std::nullopt;
}

}  // namespace

LoopStack::LoopStack(const RigConfig& config, const Design& design, const LoopWiring& wiring)
    : lines_(wiring.lines),
      late_threads_trip_(wiring.metal_moves),
      requests_(kOperatorDepth),
      reduced_(config.safety.reduced),
      answers_(kOperatorDepth),
      tick_records_(Depth(config, kTickDepth)),
      operator_ticks_(Depth(config, kOperatorTickDepth)),
      safety_records_(kSafetyDepth),
      step_(config, design),
      planner_(PlannerOf(config, design)),
      follower_(FollowerOf(config, planner_.get())),
      safety_(MakeMonitorLimits(config.safety, config.loop, wiring.metal_moves, VoltageOf(config)),
              {.lines = wiring.lines,
               .control = &control_reports_,
               .drives = wiring.drives,
               .requests = &requests_,
               .stop = &stop_,
               .disarm = &disarm_,
               .shutting_down = &shutting_down_,
               .reduced = &reduced_,
               .wakeups = wiring.wakeups,
               .permits = Joined({&control_permits_, &operator_permits_}, wiring.permits),
               .answers = &answers_,
               .records = &safety_records_,
               .timing = &timing_,
               .present = &present_},
              SafetyTask::PhaseNs(LoopGrid(config.loop))),
      control_(config.loop, config.safety.window_periods, &step_,
               {.frames = wiring.frames,
                .permits = &control_permits_,
                .calibrations = &calibrations_,
                .commands = wiring.commands,
                .reports = &control_reports_,
                .records = &tick_records_,
                .operator_ticks = &operator_ticks_,
                .planner = follower_.get()}) {}

std::vector<Task*> LoopStack::tasks() {
  std::vector<Task*> all = {&safety_, &control()};
  for (Task* task : drive_tasks()) all.push_back(task);
  if (planner_ != nullptr) all.push_back(planner_.get());
  return all;
}

}  // namespace flexarm
