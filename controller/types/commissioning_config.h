#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// Meaning of the encoder counts when the daemon starts: key `angles_at_start`.
enum class AnglesAtStart : std::uint8_t {
  kAtZero,    ///< "at_zero": the arm is at its zero, like the simulated arm
  kAbsolute,  ///< "absolute": counts are kept, so the zeros of the calibration file are valid
  kLost,  ///< "lost": angles unknown; no run before `flexarm zero` or `flexarm home` of both joints
};

/// Section [commissioning]: test of the wiring and calibration of the sensors.
struct CommissioningConfig {
  std::string calibration_file;  ///< results; relative to log.directory
  AnglesAtStart angles_at_start;
  bool prove_before_run;                  ///< refuse `run` until a pluck test has passed
  double measure_s;                       ///< averaging time of tare, zero and calibrate
  std::array<double, 2> pluck_torque_nm;  ///< of the pulse on each joint, at the gearbox output
  double pluck_pulse_s;                   ///< one direction for half of it, then the other
  double pluck_rest_s;                    ///< after each pulse
  double motion_tolerance;  ///< share by which torque and motion may differ from the model
  double gauge_tolerance;   ///< share by which a gauge may differ from the others of its link
  double home_rate_deg_per_s;
  double home_travel_deg;                  ///< longest search
  double home_back_deg;                    ///< distance from the switch afterwards
  std::array<double, 4> switch_angle_deg;  ///< hub angle at which switch 1 low, 1 high, 2 low, 2
                                           ///< high open

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
