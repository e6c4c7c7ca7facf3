#include <algorithm>
#include <cmath>

#include "config/new_rig/rig_sections.h"

namespace flexarm {
namespace {

constexpr const char* kAsThesis = "as for the thesis's rig";

std::string Pair(double first, double second) {
  return "[" + TomlNumber(first) + ", " + TomlNumber(second) + "]";
}

RigSection Section(const char* name) {
  return {.header = std::string("[") + name + "]", .comment = {}, .lines = {}};
}

// The 1 kHz grid of the safety task and the plant's steps need periods of half milliseconds.
double Period_ms(const ArmDescription& arm) {
  return std::max(2.0, 0.5 * std::round(2.0 * 1e3 / arm.At("rate_hz")));
}

RigSection Simulation(const ArmDescription& arm) {
  RigSection sim = Section("sim");
  const double lag_ms = std::min(2.0, 0.1 * Period_ms(arm));
  const double soft_deg = arm.Or("soft_angle_deg", 90.0);
  sim.Add("plant_modes", "4", "bending modes per link; the laws' model has two");
  sim.Add("seed", "1");
  sim.Add("motor_lag_ms", Pair(lag_ms, lag_ms), "assumed");
  sim.Add("transport_delay_ms", 0.0);
  sim.Add("lost_frame_fraction", 0.0);
  sim.Add("channel_skew_us", 0.0);
  sim.Add("switch_angle_deg", Pair(soft_deg + 5.0, soft_deg + 5.0), "5 degrees behind the limit");
  return sim;
}

RigSection Estimator() {
  RigSection estimator = Section("estimator");
  estimator.Add("name", "\"kalman\"", "laws that follow the payload use \"ekf-payload\" instead");
  estimator.Add("innovation_limit_rad", 0.35, kAsThesis);
  estimator.Add("fault_ticks", "3");
  return estimator;
}

RigSection Controller(const ArmDescription& arm) {
  RigSection controller = Section("controller");
  const double most_kg = arm.Or("payload_max_kg", 2.0 * arm.At("tip_mass_kg"));
  controller.Add("name", "\"gain-scheduled\"", "the payload is observable; docs/laws.md");
  controller.Add("nominal", "\"R12\"", "rigid joints, two modes a link");
  controller.Add("vartheta", 0.35, kAsThesis);
  controller.Add("sigma", 0.02, kAsThesis);
  controller.Add("feedforward_sign", "\"printed\"");
  controller.Add("adaptation_dead_zone_nm", 0.0);
  controller.Add("payload_range_kg", Pair(arm.Or("payload_min_kg", 0.0), most_kg),
                 arm.Has("payload_max_kg") ? "given" : "up to twice the usual payload");
  controller.Add("prediction", "true");
  controller.Add("adaptation", "true");
  return controller;
}

RigSection Limits(const ArmDescription& arm) {
  RigSection limits = Section("limits");
  const double soft_deg = arm.Or("soft_angle_deg", 90.0);
  limits.Add("torque_limit_nm",
             Pair(arm.At("joint1.torque_limit_nm"), arm.At("joint2.torque_limit_nm")), "given");
  limits.Add("soft_angle_deg", Pair(soft_deg, soft_deg),
             arm.Has("soft_angle_deg") ? "given" : "assumed: within what the rig's stops permit");
  limits.Add("plan_fraction", arm.Or("plan_fraction", 0.6),
             "of every limit, for moves without duration_s");
  return limits;
}

RigSection Safety() {
  RigSection safety = Section("safety");
  safety.Add("rest_hub_rate_rad_s", 0.05, kAsThesis);
  safety.Add("rest_time_s", 0.5);
  safety.Add("fault_stop_s", 1.5);
  safety.Add("permit_timeout_ms", 5.0);
  safety.Add("missed_deadlines_to_trip", "3");
  safety.Add("overrun_to_trip_ms", 5.0);
  safety.Add("window_periods", "200");
  safety.Add("missed_deadlines_in_window", "16");
  safety.Add("failed_exchanges_in_window", "16");
  safety.Add("slow_exchanges_in_window", "16");
  safety.Add("homing_contact_s", 2.0);
  safety.Add("homing_torque_fraction", 0.3);
  safety.Add("prove_days", 90.0);
  return safety;
}

RigSection Commissioning(const ArmDescription& arm) {
  RigSection commissioning = Section("commissioning");
  const double switch_deg = arm.Or("soft_angle_deg", 90.0) + 5.0;
  const std::string low = TomlNumber(-switch_deg), high = TomlNumber(switch_deg);
  commissioning.Add("calibration_file", "\"calibration.json\"");
  commissioning.Add("angles_at_start", "\"at_zero\"");
  commissioning.Add("prove_before_run", "false");
  commissioning.Add("measure_s", 1.0);
  commissioning.Add("pluck_pulse_s", 0.4);
  commissioning.Add("pluck_rest_s", 0.8);
  commissioning.Add("motion_tolerance", 0.3);
  commissioning.Add("gauge_tolerance", 0.05);
  commissioning.Add("home_rate_deg_per_s", 5.0);
  commissioning.Add("home_travel_deg", 45.0);
  commissioning.Add("home_back_deg", 10.0);
  commissioning.Add("switch_angle_deg", "[" + low + ", " + high + ", " + low + ", " + high + "]",
                    "limit 1 low, 1 high, 2 low, 2 high; measure them");
  return commissioning;
}

RigSection Loop(const ArmDescription& arm) {
  RigSection loop = Section("loop");
  const double period_ms = Period_ms(arm), rate_hz = arm.At("rate_hz");
  const bool exact = std::abs(1e3 / period_ms - rate_hz) < 1e-6 * rate_hz;
  loop.Add("period_ms", period_ms,
           exact ? "given: " + TomlNumber(rate_hz) + " Hz"
                 : "given " + TomlNumber(rate_hz) + " Hz, in half milliseconds");
  loop.Add("output", "\"next_tick\"");
  loop.Add("output_after_ms", 0.75 * period_ms);
  loop.Add("actuation_delay_ms", 0.0);
  return loop;
}

}  // namespace

std::vector<RigSection> LoopSections(const ArmDescription& arm) {
  RigSection daemon = Section("daemon"), log = Section("log"), hal = Section("hal");
  daemon.Add("socket", "\"/run/flexarm/flexarmd.sock\"");
  daemon.Add("state_directory", "\"runs\"");
  log.Add("directory", "\"runs\"");
  hal.comment = "The simulated arm. For the rig: docs/hardware.md.";
  hal.Add("backend", "\"sim\"");
  return {Simulation(arm),
          Estimator(),
          Section("estimator.payload"),
          Controller(arm),
          Section("controller.payload"),
          Limits(arm),
          Safety(),
          Commissioning(arm),
          Loop(arm),
          daemon,
          log,
          hal};
}

}  // namespace flexarm
