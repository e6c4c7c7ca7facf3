#pragma once

#include <array>
#include <optional>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// Largest safety.window_periods.
inline constexpr int kLongestWindow = 256;

/// Sections [limits] and [safety].
struct SafetyConfig {
  // [limits]
  std::array<double, 2> torque_limit_nm;  ///< at the gearbox output
  std::array<double, 2> slew_limit_nm_per_s;
  std::array<double, 2> soft_angle_deg;  ///< |hub angle| beyond this trips
  std::array<double, 2> hub_rate_rad_s;  ///< a hub rate beyond this on two ticks trips
  std::array<double, 2> strain_limit;    ///< |fitted surface strain at the root| beyond this trips
  /// A hub farther than this from its reference trips; none: it is not checked.
  std::optional<std::array<double, 2>> following_error_deg;
  double plan_fraction;  ///< share of each limit for a move without duration_s, 0 to 1
  // [safety]
  double rest_hub_rate_rad_s;      ///< at rest: both hub rates below this
  double rest_strain_rate_per_s;   ///< at rest: both root strain rates below this
  double rest_time_s;              ///< for at least this long
  double stop_timeout_s;           ///< Stopping longer than this trips
  double fault_stop_s;             ///< FaultStopping lasts this long at most; 0: it is not used
  double permit_timeout_ms;        ///< a permit older than this means zero torque
  int missed_deadlines_to_trip;    ///< consecutive missed deadlines of the control task
  double overrun_to_trip_ms;       ///< a safety tick that renews an older permit than this trips
  int window_periods;              ///< the next three limits look at the last so many periods
  int missed_deadlines_in_window;  ///< so many missed deadlines of the control task among them trip
  int failed_exchanges_in_window;  ///< so many failed exchanges of one bus among them trip
  int slow_exchanges_in_window;    ///< so many that took longer than the bus declares trip
  double homing_contact_s;         ///< homing that is longer on its switch, in all, trips
  double homing_torque_fraction;   ///< share of limits.torque_limit_nm while homing, 0 to 1
  double prove_days;               ///< how long a proof of the switches permits runs; a wired rig
  double disarm_after_s = 600.0;   ///< Armed without a run for this long disarms; 0: never
  bool reduced = false;            ///< the daemon starts with reduced limits (WithReducedLimits)
  double reduced_torque = 0.5;     ///< shares of the limits then, 0 to 1: of the torque,
  double reduced_rate = 0.25;      ///< of the hub rate,
  double reduced_angle = 0.5;      ///< and of the soft angle and the following error

  std::vector<Problem> Problems() const;
};

/// The reduced limits in place of the full ones, for first motions of a rig.
SafetyConfig WithReducedLimits(SafetyConfig safety) noexcept;

/// The soft limits in rad.
std::array<double, 2> SoftAngleRad(const SafetyConfig& safety) noexcept;

}  // namespace flexarm
