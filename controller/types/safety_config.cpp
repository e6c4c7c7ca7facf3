#include "controller/types/safety_config.h"

#include <cstddef>

#include "model/problem_list.h"
#include "model/units.h"

namespace flexarm {
namespace {

void CheckLimits(const SafetyConfig& c, ProblemList* list) {
  list->EachPositive("limits.torque_limit_nm", c.torque_limit_nm, 1000.0,
                     "the torque gate limits to +-this, at the gearbox output");
  list->EachPositive("limits.slew_limit_nm_per_s", c.slew_limit_nm_per_s, 1e6,
                     "the torque gate limits the rate of change to this");
  list->EachPositive("limits.soft_angle_deg", c.soft_angle_deg, 360.0,
                     "a hub angle beyond +-this trips");
  list->EachPositive("limits.hub_rate_rad_s", c.hub_rate_rad_s, 100.0,
                     "a hub rate beyond this trips");
  list->EachPositive("limits.strain_limit", c.strain_limit, 0.01,
                     "unit strain; a metal link fails below 1 %");
  if (c.following_error_deg) {
    list->EachPositive("limits.following_error_deg", *c.following_error_deg, 360.0,
                       "a hub farther than this from its reference trips");
  }
  list->Positive("limits.plan_fraction", c.plan_fraction, 1.0,
                 "a move without duration_s is planned within this share of every limit");
}

void CheckSafety(const SafetyConfig& c, ProblemList* list) {
  list->Positive("safety.rest_hub_rate_rad_s", c.rest_hub_rate_rad_s, 10.0,
                 "at rest both hub rates are below this");
  list->Positive("safety.rest_strain_rate_per_s", c.rest_strain_rate_per_s, 1.0,
                 "at rest both root strain rates are below this");
  list->Within("safety.rest_time_s", c.rest_time_s, 0.05, 10.0,
               "the duration of rest; an oscillation is slow at its turning points");
  list->Within("safety.stop_timeout_s", c.stop_timeout_s, 0.1, 10.0,
               "Stopping for longer than this trips; the service ends within 15 s");
  list->Within(
      "safety.fault_stop_s", c.fault_stop_s, 0.0, 2.0,
      "how long the arm is damped after a cause of stop category 1, before the power goes");
  list->Within("safety.permit_timeout_ms", c.permit_timeout_ms, 2.0, 20.0,
               "the permit is renewed every 1 ms; an older one means zero torque");
  list->Within("safety.missed_deadlines_to_trip", c.missed_deadlines_to_trip, 1, 10,
               "consecutive deadlines of the control task");
  list->Within("safety.overrun_to_trip_ms", c.overrun_to_trip_ms, 2.0, 1000.0,
               "a safety tick that finds an older permit, renewed every 1 ms, trips");
  list->Within("safety.window_periods", c.window_periods, 10, kLongestWindow,
               "the limits ..._in_window count in the last so many periods");
  list->Within("safety.homing_contact_s", c.homing_contact_s, 0.1, 10.0,
               "how long homing may be on the switch that it searches for, in all");
  list->Positive("safety.homing_torque_fraction", c.homing_torque_fraction, 1.0,
                 "the share of limits.torque_limit_nm that homing may use");
  list->Within("safety.prove_days", c.prove_days, 1.0, 366.0,
               "how long a proof of the switches permits runs");
  list->Within("safety.disarm_after_s", c.disarm_after_s, 0.0, 86400.0,
               "how long the arm may be armed without a run; 0: for ever");
  list->Positive("safety.reduced_torque", c.reduced_torque, 1.0,
                 "the share of limits.torque_limit_nm while the limits are reduced");
  list->Positive("safety.reduced_rate", c.reduced_rate, 1.0,
                 "the share of limits.hub_rate_rad_s while the limits are reduced");
  list->Positive("safety.reduced_angle", c.reduced_angle, 1.0,
                 "the share of limits.soft_angle_deg while the limits are reduced");
}

}  // namespace

std::vector<Problem> SafetyConfig::Problems() const {
  ProblemList list("");
  CheckLimits(*this, &list);
  CheckSafety(*this, &list);
  if (!list.empty())
    return list.Take();  // the rules between values assume that each value is valid
  for (std::size_t i = 0; i < hub_rate_rad_s.size(); ++i) {
    list.Require(rest_hub_rate_rad_s < hub_rate_rad_s[i], "safety.rest_hub_rate_rad_s",
                 NumberText(rest_hub_rate_rad_s),
                 "must be below limits.hub_rate_rad_s[" + NumberText(i) +
                     "] = " + NumberText(hub_rate_rad_s[i]) + ", or an arm at rest could trip");
    if (!(rest_hub_rate_rad_s < hub_rate_rad_s[i])) continue;
    list.Require(rest_hub_rate_rad_s < reduced_rate * hub_rate_rad_s[i], "safety.reduced_rate",
                 NumberText(reduced_rate),
                 "times limits.hub_rate_rad_s[" + NumberText(i) + "] = " +
                     NumberText(hub_rate_rad_s[i]) + " must be above safety.rest_hub_rate_rad_s");
  }
  const auto within_window = [&](const char* key, int limit) {
    list.Within(key, limit, 1, window_periods,
                "so many of the last safety.window_periods = " + NumberText(window_periods) +
                    " trip, wherever they lie");
  };
  within_window("safety.missed_deadlines_in_window", missed_deadlines_in_window);
  within_window("safety.failed_exchanges_in_window", failed_exchanges_in_window);
  within_window("safety.slow_exchanges_in_window", slow_exchanges_in_window);
  list.Require(
      stop_timeout_s > rest_time_s, "safety.stop_timeout_s", NumberText(stop_timeout_s),
      "must be above safety.rest_time_s = " + NumberText(rest_time_s) + ", or every stop trips");
  return list.Take();
}

SafetyConfig WithReducedLimits(SafetyConfig safety) noexcept {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    safety.torque_limit_nm[joint] *= safety.reduced_torque;
    safety.hub_rate_rad_s[joint] *= safety.reduced_rate;
    safety.soft_angle_deg[joint] *= safety.reduced_angle;
    if (safety.following_error_deg) (*safety.following_error_deg)[joint] *= safety.reduced_angle;
  }
  return safety;
}

std::array<double, 2> SoftAngleRad(const SafetyConfig& safety) noexcept {
  return {safety.soft_angle_deg[0] * kRadPerDeg, safety.soft_angle_deg[1] * kRadPerDeg};
}

}  // namespace flexarm
