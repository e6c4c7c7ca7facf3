#pragma once

#include <array>
#include <string>
#include <vector>

#include "controller/types/commissioning_config.h"
#include "controller/types/records.h"
#include "controller/types/rig_config.h"

namespace flexarm {

// The pluck test checks the wiring: a small open-loop torque on one joint, then on the other; the
// responses of every encoder and gauge are compared with the model. Not real-time.

/// The torques of the test, sample by sample: rest, a pulse each way on joint 1, rest, the same on
/// joint 2, rest. Each pair of pulses has zero area, so the arm ends at rest near its start.
std::vector<std::array<double, 2>> PluckTorques(const CommissioningConfig& config, double period_s);

/// Response of one channel to the test.
struct PluckAnswer {
  std::string channel;  ///< "hub1", "strain_1_01", "drive1" (the median of its joint's channels)
  double gain;          ///< measured over expected motion, nominally 1
  double match;         ///< share of the motion that `gain` times the expected motion explains
  bool provable;        ///< the test moves this channel enough for a result
};

/// A channel with a wiring fault, and the fault.
struct PluckFinding {
  std::string channel;
  std::string problem;
};

struct PluckVerdict {
  std::vector<PluckAnswer> answer;    ///< drives, encoders, strain channels
  std::vector<PluckFinding> finding;  ///< empty: the wiring is correct
  bool passed() const { return finding.empty(); }
};

/// @param run  the samples from the start of the test to its end, or to the trip that ended it
PluckVerdict JudgePluck(const RigConfig& config, const std::vector<TickRecord>& run);

}  // namespace flexarm
