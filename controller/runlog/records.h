#pragma once

#include <array>
#include <cstdint>

#include "controller/law/step_types.h"

namespace flexarm {

/// What the simulated arm really did at a sampling instant. A rig does not know it.
struct PlantTruth {
  std::array<double, 2> hub_angle_rad;  ///< th1, th2
  std::array<double, 2> tip_m;          ///< x, y in the base frame
  std::array<double, 2> tip_deflection_m;  ///< w1(L1), w2(L2)
  bool known;
};

/// One sample as the control task hands it to the recorder.
struct TickRecord {
  StepInput input;
  StepOutput output;
  PlantTruth truth;
};

/// Wall-clock figures of one activation of a task.
struct TimingRecord {
  std::int64_t tick;         ///< of the control task; activation number otherwise
  std::int64_t due_ns;
  std::int64_t woke_ns;      ///< in the clock of the loop
  std::int64_t finished_ns;
};

}  // namespace flexarm
