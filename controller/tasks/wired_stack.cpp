#include "controller/tasks/wired_stack.h"

#include "controller/types/rounded_text.h"

namespace flexarm {
namespace {

constexpr double kMsPerNs = 1e-6;

}  // namespace

LoopWiring BusWires::Wiring(SafetyLines* lines) {
  LoopWiring wiring{.lines = lines, .frames = {}, .commands = {}, .permits = {}, .drives = {}};
  for (Bus& bus : wires) {
    wiring.frames.push_back(&bus.frames);
    wiring.commands.push_back(&bus.commands);
    wiring.permits.push_back(&bus.permits);
    wiring.drives.push_back(&bus.reports);
    wiring.wakeups.push_back(&bus.wakeup);
  }
  return wiring;
}

WiredStack::WiredStack(const RigConfig& config, const Design& design, const RigWires& rig)
    : BusWires(rig),
      LoopStack(config, design, Wiring(rig.lines)),
      devices_(rig.buses),
      window_periods_(config.safety.window_periods) {
  for (std::size_t i = 0; i < wires.size(); ++i) {
    tasks_.emplace_back(config, rig.buses[i],
                        BusChannels{.commands = &wires[i].commands,
                                    .permits = &wires[i].permits,
                                    .frames = &wires[i].frames,
                                    .reports = &wires[i].reports,
                                    .health = &wires[i].health,
                                    .counters = &wires[i].counters,
                                    .wakeup = &wires[i].wakeup});
  }
}

std::vector<Task*> WiredStack::drive_tasks() {
  std::vector<Task*> tasks;
  tasks.reserve(tasks_.size());
  for (BusTask& task : tasks_) tasks.push_back(&task);
  return tasks;
}

void WiredStack::SetEpoch(std::int64_t epoch_ns) noexcept {
  for (BusTask& task : tasks_) task.SetEpoch(epoch_ns);
}

std::vector<BusHealth> WiredStack::buses() {
  std::vector<BusHealth> all;
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    const DriveReport& report = wires[i].health.Read().Newest().value;
    const auto text = [&](const BusFault& fault) {
      return fault == BusFault{} ? std::string() : devices_[i]->FaultText(fault);
    };
    all.push_back({.name = devices_[i]->name(),
                   .ok = report.bus_ok || report.due_ns == INT64_MIN,  // ok before its first run
                   .fault = text(report.fault),
                   .failed = report.failed,
                   .recovered = report.recovered,
                   .slow = report.slow,
                   .longest_ms = static_cast<double>(report.longest_ns) * kMsPerNs,
                   .declared_ms = static_cast<double>(devices_[i]->worst_case_ns()) * kMsPerNs,
                   .failed_in_window = report.failed_in_window,
                   .slow_in_window = report.slow_in_window,
                   .in_fault = report.bus_ok && !report.drive_ok,
                   .notice = text(report.notice),
                   .counters = Counters(i)});
  }
  return all;
}

std::vector<BusCounter> WiredStack::Counters(std::size_t bus) {
  const BusCounters& values = wires[bus].counters.Read();
  std::vector<BusCounter> all;
  for (const char* name : devices_[bus]->counter_names()) {
    all.push_back({.name = name, .value = values[all.size()]});
  }
  return all;
}

CountEpochs WiredStack::count_epochs() {
  CountEpochs all{};
  for (Bus& bus : wires) {
    const CountEpochs& of_bus = bus.health.Read().Newest().value.count_epochs;
    for (std::size_t i = 0; i < all.size(); ++i) all[i] += of_bus[i];
  }
  return all;
}

std::string WiredStack::Share(const Evidence& evidence) const {
  return RoundedText(evidence.value, 3) + " of the last " + std::to_string(window_periods_) +
         " exchanges ";
}

std::string WiredStack::BusText(TripCause cause, const Evidence& evidence) const {
  if (evidence.channel < 1 || evidence.channel > devices_.size()) return {};
  const BusDevice& device = *devices_[evidence.channel - 1];
  const BusFault fault = FaultFromBits(evidence.detail);
  if (cause == TripCause::kBusTooSlow) {
    return device.name() + (": " + Share(evidence)) + "took longer than the " +
           RoundedText(static_cast<double>(device.worst_case_ns()) * kMsPerNs, 3) +
           " ms it declares";
  }
  if (cause == TripCause::kBusUnreliable) {
    const std::string last = evidence.detail == 0 ? "" : "; the last: " + device.FaultText(fault);
    return device.name() + (": " + Share(evidence)) + "failed" + last;
  }
  const bool of_bus = cause == TripCause::kBusLost || cause == TripCause::kDriveFault ||
                      cause == TripCause::kStaleFrame;
  if (!of_bus || evidence.detail == 0) return {};
  if (fault.kind == kBusHangs) return std::string(device.name()) + ": its exchange does not end";
  return device.FaultText(fault);
}

}  // namespace flexarm
