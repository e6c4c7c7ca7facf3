#include "controller/runtime/simulated_stack.h"

#include <algorithm>

namespace flexarm {
namespace {

// At least 60 s deep (docs/architecture.md): a recorder that is stuck that long loses nothing.
constexpr std::size_t kTickDepth = 4'000;
constexpr std::size_t kSafetyDepth = 60'000;
constexpr std::size_t kOperatorDepth = 64;

}  // namespace

SimulatedStack::SimulatedStack(const StackConfig& config, const Design& design, double payload_kg)
    : outputs_(OutputHistory({.relay_closed = false, .pump_level = false})),
      levels_(LevelHistory(kHealthyLevels)),
      requests_(kOperatorDepth),
      answers_(kOperatorDepth),
      presses_(kOperatorDepth),
      tick_records_(kTickDepth),
      safety_records_(kSafetyDepth),
      lines_(&levels_, &outputs_),
      step_(config, design),
      safety_(MakeSupervisorLimits(config.safety, config.loop),
              {.lines = &lines_,
               .control = &control_reports_,
               .drive = &drive_reports_,
               .requests = &requests_,
               .permits = {&control_permits_, &plant_permits_, &operator_permits_},
               .answers = &answers_,
               .records = &safety_records_}),
      control_(config.loop, &step_,
               {.frames = &frames_,
                .permits = &control_permits_,
                .plans = &control_plans_,
                .commands = &commands_,
                .reports = &control_reports_,
                .records = &tick_records_,
                .telemetry = &telemetry_}),
      plant_(config, payload_kg,
             {.commands = &commands_,
              .permits = &plant_permits_,
              .outputs = &outputs_,
              .plans = &plant_plans_,
              .presses = &presses_,
              .frames = &frames_,
              .levels = &levels_,
              .reports = &drive_reports_}) {}

void SimulatedStack::Plan(const PlannedRun& plan) noexcept {
  control_plans_.Publish(plan);
  plant_plans_.Publish(plan);
}

std::uint32_t SimulatedStack::released_plans() const noexcept {
  return std::min(control_.released(), plant_.released());
}

}  // namespace flexarm
