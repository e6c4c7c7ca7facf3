#pragma once

#include <deque>
#include <string>
#include <vector>

#include "controller/tasks/bus_task.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// The opened buses and the safety chain of a rig. Outlive the stack.
struct RigWires {
  std::vector<BusDevice*> buses;  ///< at least one
  SafetyLines* lines;
};

/// The channels between the loop and the buses. A base of WiredStack, so that they are constructed
/// before the tasks that use them.
struct BusWires {
  struct Bus {
    FrameChannel frames{FrameHistory(kNoFrame)};
    CommandChannel commands{CommandHistory(kNoCommand)};
    PermitChannel permits{PermitHistory(kNoPermit)};
    DriveReportChannel reports{DriveReportHistory(kNoDriveReport)};
    DriveReportChannel health{DriveReportHistory(kNoDriveReport)};
    BusCounterChannel counters{BusCounters{}};
    Wakeup wakeup;
  };

  explicit BusWires(const RigWires& rig) : wires(rig.buses.size()) {}
  LoopWiring Wiring(SafetyLines* lines);

  std::deque<Bus> wires;
};

/// The daemon's real-time tasks on a hardware rig, with one thread a bus.
class WiredStack final : private BusWires, public LoopStack {
 public:
  WiredStack(const RigConfig& config, const Design& design, const RigWires& rig);

  std::vector<Task*> drive_tasks() override;

  void SetEpoch(std::int64_t epoch_ns) noexcept override;

  std::vector<BusHealth> buses() override;
  CountEpochs count_epochs() override;
  std::string BusText(TripCause cause, const Evidence& evidence) const override;

 private:
  std::vector<BusCounter> Counters(std::size_t bus);
  /// "16 of the last 200 exchanges "
  std::string Share(const Evidence& evidence) const;

  std::vector<BusDevice*> devices_;
  int window_periods_;
  std::deque<BusTask> tasks_;
};

}  // namespace flexarm
