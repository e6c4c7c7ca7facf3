#pragma once

#include <string>
#include <vector>

#include "controller/tasks/simulated_stack.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {

/// A stack whose tasks do not run: a test says what its backend is, and sees what it was given.
class StillStack final : private SimulatedWires, public LoopStack {
 public:
  explicit StillStack(const RigConfig& config = ShippedRig())
      : LoopStack(config, ShippedDesign(),
                  {.lines = &lines,
                   .frames = {&frames},
                   .commands = {&commands},
                   .permits = {&permits},
                   .drives = {&drive_reports}}) {}

  std::vector<Task*> drive_tasks() override { return {}; }
  std::uint32_t released_experiments() const noexcept override { return released; }
  std::string BusText(TripCause, const Evidence&) const override { return bus_text; }
  bool simulated() const noexcept override { return is_simulated; }
  bool Press(const LinePress& press) noexcept override {
    pressed = press;
    return is_simulated;
  }

  /// The requests that were made since the last call.
  std::vector<OperatorRequest> TakeRequests() {
    std::vector<OperatorRequest> all;
    for (OperatorRequest request{}; requests().Pop(&request);) all.push_back(request);
    return all;
  }

  std::uint32_t released = 0;
  std::string bus_text;
  bool is_simulated = true;
  LinePress pressed{.line = Line::kLimit1Low, .level = -1};  ///< the newest
};

}  // namespace flexarm
