#include "config/rig_sections.h"

namespace flexarm {
namespace {

void ReadLimits(TableReader limits, SafetyConfig* out) {
  limits.Read(
      "torque_limit_nm", &out->torque_limit_nm,
      "largest torque of joint 1, 2 at the gearbox output; the gate cuts off what is above");
  limits.Read("slew_limit_nm_per_s", &out->slew_limit_nm_per_s,
              "fastest change of the torque of joint 1, 2; the gate delays the rest");
  limits.Read(
      "soft_angle_deg", &out->soft_angle_deg,
      "hub angle of joint 1, 2, in both directions, beyond which the arm trips: soft-limit");
  limits.Read(
      "hub_rate_rad_s", &out->hub_rate_rad_s,
      "rate of hub 1, 2, estimated or measured over 20 ms, beyond which the arm trips: hub-rate");
  limits.Read(
      "strain_limit", &out->strain_limit,
      {"strain at the root of link 1, 2 beyond which the arm trips: bending-strain", "strain"});
  limits.ReadIfGiven("following_error_deg", &out->following_error_deg,
                     "distance of hub 1, 2 from its reference in a run beyond which the arm trips: "
                     "following-error; without the key it is not checked");
  limits.Read("plan_fraction", &out->plan_fraction,
              {"share of every limit that a move without duration_s may use", "1"});
}

void ReadRest(TableReader safety, SafetyConfig* out) {
  safety.Read("rest_hub_rate_rad_s", &out->rest_hub_rate_rad_s,
              "the arm is at rest when both hubs are slower than this, "
              "and what the next two keys say holds");
  safety.Read("rest_strain_rate_per_s", &out->rest_strain_rate_per_s,
              {"the strains at both roots change less than this at rest", "strain/s"});
  safety.Read("rest_time_s", &out->rest_time_s,
              "the arm must have been so for this long to be at rest");
  safety.Read("stop_timeout_s", &out->stop_timeout_s,
              "a stop that takes longer trips: stop-timeout");
  safety.Read("fault_stop_s", &out->fault_stop_s,
              "after a trip by angle, rate or strain the arm is damped for so long; 0: its torque "
              "ends at once");
  safety.Read("permit_timeout_ms", &out->permit_timeout_ms,
              "a drive gets no torque when the permit of the safety thread is older");
}

void ReadTimingLimits(TableReader safety, SafetyConfig* out) {
  safety.Read("missed_deadlines_to_trip", &out->missed_deadlines_to_trip,
              {"so many missed deadlines of the control thread in a row trip: missed-deadlines",
               "deadlines"});
  safety.Read("overrun_to_trip_ms", &out->overrun_to_trip_ms,
              "a safety thread that is later trips: safety-overrun; counted only on the simulated "
              "arm");
  safety.Read("window_periods", &out->window_periods,
              "length of the window of the next three keys");
  safety.Read("missed_deadlines_in_window", &out->missed_deadlines_in_window,
              {"so many missed deadlines in the window trip: deadlines-often-missed", "deadlines"});
  safety.Read(
      "failed_exchanges_in_window", &out->failed_exchanges_in_window,
      {"so many failed exchanges with one bus in the window trip: bus-unreliable", "exchanges"});
  safety.Read(
      "slow_exchanges_in_window", &out->slow_exchanges_in_window,
      {"so many exchanges that took longer than the bus declares trip: bus-too-slow", "exchanges"});
}

void ReadHoming(TableReader commissioning, CommissioningConfig* out) {
  commissioning.Read("home_rate_deg_per_s", &out->home_rate_deg_per_s,
                     "`flexarm home`: speed towards the switch");
  commissioning.Read("home_travel_deg", &out->home_travel_deg,
                     "`flexarm home`: longest way to the switch");
  commissioning.Read("home_back_deg", &out->home_back_deg,
                     "`flexarm home`: distance from the switch afterwards");
  commissioning.Read("switch_angle_deg", &out->switch_angle_deg,
                     "hub angles at which the limit switches open: joint 1 low, high, joint 2 low, "
                     "high; homing takes the zero from them");
}

}  // namespace

void ReadSafety(TableReader root, SafetyConfig* out) {
  ReadLimits(root.Table("limits", "what the arm may do"), out);
  TableReader safety = root.Table("safety", "when it is at rest, and when it trips");
  ReadRest(safety, out);
  ReadTimingLimits(safety, out);
  safety.Read("homing_contact_s", &out->homing_contact_s,
              "homing that is longer on its switch, in all, trips");
  safety.Read("homing_torque_fraction", &out->homing_torque_fraction,
              {"share of limits.torque_limit_nm that homing may use", "1"});
  safety.Read("prove_days", &out->prove_days,
              "a wired rig runs for so long after `flexarm prove-switches`");
  safety.ReadIfGiven("disarm_after_s", &out->disarm_after_s,
                     "an arm that is armed without a run for so long is disarmed; 0: never");
  safety.ReadIfGiven("reduced", &out->reduced,
                     "true: the daemon starts with reduced limits, for first motions, until "
                     "`flexarm limits full`");
  safety.ReadIfGiven("reduced_torque", &out->reduced_torque,
                     {"share of limits.torque_limit_nm while the limits are reduced", "1"});
  safety.ReadIfGiven("reduced_rate", &out->reduced_rate,
                     {"the same of limits.hub_rate_rad_s", "1"});
  safety.ReadIfGiven("reduced_angle", &out->reduced_angle,
                     {"the same of limits.soft_angle_deg and limits.following_error_deg", "1"});
}

void ReadCommissioning(TableReader commissioning, CommissioningConfig* out) {
  commissioning.Read(
      "calibration_file", &out->calibration_file,
      "file of what tare, zero, home and calibrate found, relative to log.directory");
  commissioning.Read("angles_at_start", &out->angles_at_start,
                     {{"at_zero", AnglesAtStart::kAtZero},
                      {"absolute", AnglesAtStart::kAbsolute},
                      {"lost", AnglesAtStart::kLost}},
                     "what the counters mean at the start: the arm is at its zero, absolute "
                     "encoders keep theirs, or nothing is known before `flexarm zero` or `flexarm "
                     "home`");
  commissioning.Read("prove_before_run", &out->prove_before_run,
                     "true: no run before `flexarm pluck` has passed");
  commissioning.Read("measure_s", &out->measure_s,
                     "`flexarm tare`, `zero` and `calibrate` average over this time");
  commissioning.Read("pluck_torque_nm", &out->pluck_torque_nm,
                     "`flexarm pluck`: torque of the pulse on joint 1, 2");
  commissioning.Read("pluck_pulse_s", &out->pluck_pulse_s,
                     "`flexarm pluck`: length of a pulse, half of it each way");
  commissioning.Read("pluck_rest_s", &out->pluck_rest_s, "`flexarm pluck`: pause after each pulse");
  commissioning.Read(
      "motion_tolerance", &out->motion_tolerance,
      {"`flexarm pluck`: share by which torque and motion may differ from the model", "1"});
  commissioning.Read(
      "gauge_tolerance", &out->gauge_tolerance,
      {"`flexarm pluck`: share by which a gauge may differ from its link's others", "1"});
  ReadHoming(commissioning, out);
}

}  // namespace flexarm
