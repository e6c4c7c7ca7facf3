#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// What the encoders say when the daemon starts: key `angles_at_start`.
enum class AnglesAtStart : std::uint8_t {
  kAtZero,    ///< "at_zero": the arm stands at its zero, as a simulated one does
  kAbsolute,  ///< "absolute": they remember, so the zeros of the calibration file hold
  kLost,      ///< "lost": no run before `flexarm zero` or `flexarm home` of both joints
};

/// Section [commissioning]: how the wiring of a rig is proven, and its sensors calibrated.
struct CommissioningConfig {
  std::string calibration_file;  ///< what was found; relative to log.directory
  AnglesAtStart angles_at_start;
  bool prove_before_run;                  ///< refuse `run` until a pluck test has passed
  double measure_s;                       ///< averaging time of tare, zero and calibrate
  std::array<double, 2> pluck_torque_nm;  ///< of the pulse on each joint, at the gearbox output
  double pluck_pulse_s;                   ///< one way for half of it, then the other
  double pluck_rest_s;                    ///< after each pulse
  double motion_tolerance;  ///< share by which torque and motion may differ from the model's
  double gauge_tolerance;   ///< share by which a gauge may differ from the rest of its link
  double home_rate_deg_per_s;
  double home_travel_deg;                  ///< searched at most
  double home_back_deg;                    ///< off the switch afterwards
  std::array<double, 4> switch_angle_deg;  ///< hub angle at which limit 1 low, 1 high, 2 low, 2
                                           ///< high open

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
