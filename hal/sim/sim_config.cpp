#include "hal/sim/sim_config.h"

#include <cmath>

#include "model/problem_list.h"

namespace flexarm {

std::vector<Problem> SimConfig::Problems() const {
  ProblemList list("sim.");
  list.Within("plant_modes", plant_modes, 1, 6, "bending modes per link of the plant");
  const double steps_per_ms = 1.0 / step_ms;
  // 1e-9: the rounding of a decimal step such as 0.2, far below the nearest wrong one (0.3).
  list.Require(step_ms >= 0.001 && step_ms <= 1.0 &&
                   std::abs(steps_per_ms - std::nearbyint(steps_per_ms)) < 1e-9 * steps_per_ms,
               "step_ms", NumberText(step_ms),
               "must lie in 0.001 .. 1 and divide 1 ms, or the steps miss the 1 kHz safety grid");
  list.EachWithin("motor_lag_ms", motor_lag_ms, 0.0, 100.0, "electrical time constant, 0 for none");
  list.Within("transport_delay_ms", transport_delay_ms, 0.0, 40.0,
              "from command to drive, in addition to the loop's own delay");
  list.Within("lost_frame_fraction", lost_frame_fraction, 0.0, 0.5,
              "two frames are never lost in a row, as that would trip");
  list.Within("channel_skew_us", channel_skew_us, 0.0, 5000.0,
              "delay of a multiplexer from channel to channel");
  list.EachPositive("switch_angle_deg", switch_angle_deg, 360.0,
                    "the limit switches open beyond this hub angle");
  std::vector<Problem> problems = list.Take();
  const std::vector<Problem> of_drift = drift.Problems();
  problems.insert(problems.end(), of_drift.begin(), of_drift.end());
  return problems;
}

}  // namespace flexarm
