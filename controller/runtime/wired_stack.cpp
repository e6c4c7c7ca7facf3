#include "controller/runtime/wired_stack.h"

namespace flexarm {

LoopWiring BusWires::Wiring(SafetyLines* lines) {
  LoopWiring wiring{.lines = lines, .frames = {}, .commands = {}, .permits = {}, .drives = {}};
  for (Bus& bus : buses) {
    wiring.frames.push_back(&bus.frames);
    wiring.commands.push_back(&bus.commands);
    wiring.permits.push_back(&bus.permits);
    wiring.drives.push_back(&bus.reports);
  }
  return wiring;
}

WiredStack::WiredStack(const StackConfig& config, const Design& design, const RigWires& rig)
    : BusWires(rig), LoopStack(config, design, Wiring(rig.lines)) {
  for (std::size_t i = 0; i < buses.size(); ++i) {
    tasks_.emplace_back(config, rig.buses[i],
                        BusChannels{.commands = &buses[i].commands,
                                    .permits = &buses[i].permits,
                                    .frames = &buses[i].frames,
                                    .reports = &buses[i].reports});
  }
}

std::vector<Task*> WiredStack::drive_tasks() {
  std::vector<Task*> tasks;
  for (BusTask& task : tasks_) tasks.push_back(&task);
  return tasks;
}

void WiredStack::SetEpoch(std::int64_t epoch_ns) noexcept {
  for (BusTask& task : tasks_) task.SetEpoch(epoch_ns);
}

}  // namespace flexarm
