#include "controller/tasks/simulated_stack.h"

#include <algorithm>

namespace flexarm {

SimulatedStack::SimulatedStack(const RigConfig& config, const RigConfig& plant,
                               const Design& design, double payload_kg,
                               const std::array<double, 2>& start_rad)
    : LoopStack(config, design,
                {.lines = &lines,
                 .frames = {&frames},
                 .commands = {&commands},
                 .permits = {&permits},
                 .drives = {&drive_reports},
                 .metal_moves = false}),
      control_(&LoopStack::control()),
      plant_(plant, payload_kg, start_rad,
             {.commands = &commands,
              .permits = &permits,
              .outputs = &outputs,
              .presses = &presses,
              .frames = &frames,
              .levels = &levels,
              .reports = &drive_reports,
              .truth = &truth,
              .control = &control_}) {}

std::uint32_t SimulatedStack::released_experiments() const noexcept {
  return std::min(LoopStack::released_experiments(), plant_.released());
}

}  // namespace flexarm
