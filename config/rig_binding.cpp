#include "config/rig_binding.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "config/hal_binding.h"
#include "controller/types/csv_import_config.h"
#include "controller/types/law_table.h"
#include "model/units.h"

namespace flexarm {
namespace {

// A section is given by its cross-section and its material, or by rho A and EI.
void ReadSection(TableReader row, BeamSection* out) {
  row.Read("length_m", &out->length_m);
  row.Read("half_thickness_m", &out->half_thickness_m);
  constexpr std::array kCrossSection = {"area_m2", "second_moment_m4", "density_kg_m3",
                                        "youngs_modulus_pa"};
  constexpr const char* kMass = "mass_per_length_kg_m";
  constexpr const char* kStiffness = "bending_stiffness_nm2";
  const auto cross = std::count_if(kCrossSection.begin(), kCrossSection.end(),
                                   [&row](const char* key) { return row.Has(key); });
  const bool mass = row.Has(kMass), stiffness = row.Has(kStiffness);
  out->has_cross_section = cross > 0;
  if (cross > 0 && (mass || stiffness)) {
    row.Refuse(mass ? kMass : kStiffness,
               "must not be given beside area_m2, second_moment_m4, density_kg_m3 or "
               "youngs_modulus_pa: a section has its cross-section and material, or its mass per "
               "length and bending stiffness");
  } else if (cross == 0 && !mass && !stiffness) {
    row.Missing(kMass,
                "a number, beside bending_stiffness_nm2; or the section has area_m2, "
                "second_moment_m4, density_kg_m3 and youngs_modulus_pa");
    out->given_bending_stiffness_nm2 = 1.0;  // one message is enough
    return;
  }
  if (cross == 0) {
    row.Read(kMass, &out->given_mass_per_length_kg_m);
    row.Read(kStiffness, &out->given_bending_stiffness_nm2);
    return;
  }
  row.Read("area_m2", &out->area_m2);
  row.Read("second_moment_m4", &out->second_moment_m4);
  row.Read("density_kg_m3", &out->density_kg_m3);
  row.Read("youngs_modulus_pa", &out->youngs_modulus_pa);
}

void ReadLink(TableReader link, LinkParameters* out) {
  link.Read("damping_ratio", &out->damping_ratio);
  for (const TableReader& row : link.Rows("section")) {
    ReadSection(row, &out->section.emplace_back());
  }
}

void ReadJoint(TableReader joint, JointParameters* out) {
  joint.Read("stiffness_nm_per_rad", &out->stiffness_nm_per_rad);
  joint.Read("rotor_inertia_kgm2", &out->rotor_inertia_kgm2);
  joint.Read("hub_inertia_kgm2", &out->hub_inertia_kgm2);
  joint.Read("coulomb_friction_nm", &out->coulomb_friction_nm);
  joint.Read("viscous_friction_nm_s_per_rad", &out->viscous_friction_nm_s_per_rad);
}

void ReadBacklash(TableReader joint2, BacklashParameters* out) {
  joint2.Read("backlash_model", &out->model,
              {{"dead_zone", BacklashModel::kDeadZone}, {"thesis", BacklashModel::kThesis}});
  joint2.Read("backlash_rad", &out->clearance_rad);
  joint2.Read("restitution_slope_s_per_rad", &out->restitution_slope_s_per_rad);
}

void ReadArm(TableReader root, ArmParameters* out) {
  ReadLink(root.Table("link1"), &out->link.front());
  ReadLink(root.Table("link2"), &out->link.back());
  ReadJoint(root.Table("joint1"), &out->joint.front());
  TableReader joint2 = root.Table("joint2");
  ReadJoint(joint2, &out->joint.back());
  ReadBacklash(joint2, &out->joint2_backlash);
  TableReader arm = root.Table("arm");
  arm.Read("hub2_mass_kg", &out->hub2_mass_kg);
  arm.Read("motor2_mass_kg", &out->motor2_mass_kg);
  arm.Read("motor2_inertia_kgm2", &out->motor2_inertia_kgm2);
  arm.Read("payload_mass_kg", &out->payload_mass_kg);
  arm.Read("payload_inertia_kgm2", &out->payload_inertia_kgm2);
  arm.Read("shape_payload_mass_kg", &out->shape_payload_mass_kg);
  arm.Read("foreshortening", &out->foreshortening);
  arm.Read("damping", &out->damping,
           {{"none", DampingReading::kNone},
            {"ca_rho", DampingReading::kCurvatureRho},
            {"ca_lit", DampingReading::kCurvatureAsPrinted},
            {"modal", DampingReading::kModal}});
  arm.Read(
      "link1_tip_inertia", &out->link1_tip_inertia,
      {{"motor", Link1TipInertia::kMotor}, {"motor_and_rotor", Link1TipInertia::kMotorAndRotor}});
}

void ReadEncoder(TableReader row, EncoderConfig* out) {
  row.Read<int>("joint", &out->counter, {{"hub1", 0}, {"hub2", 1}, {"rotor1", 2}, {"rotor2", 3}});
  row.Read("counts_per_turn", &out->counts_per_turn);
  row.Read("counter_bits", &out->counter_bits);
  row.Read("sign", &out->sign);
}

void ReadStrainChannel(TableReader row, StrainChannelConfig* out) {
  row.Read("link", &out->link);
  row.Read("position_m", &out->position_m);
  row.Read("face", &out->face);
  row.Read("gain_v_per_unit", &out->gain_v_per_unit);
  row.Read("offset_counts", &out->offset_counts);
}

void ReadTipAccelerometer(TableReader sensor, TipAccelerometerConfig* out) {
  sensor.Read("range_m_s2", &out->range_m_s2);
  sensor.Read("converter_bits", &out->converter_bits);
  sensor.Read("noise_counts", &out->noise_counts);
  sensor.Read("filter_hz", &out->filter_hz);
}

void ReadSensors(TableReader sensors, SensorConfig* out) {
  for (const TableReader& row : sensors.Rows("encoder")) {
    ReadEncoder(row, &out->encoder.emplace_back());
  }
  for (const TableReader& row : sensors.Rows("strain")) {
    ReadStrainChannel(row, &out->strain.emplace_back());
  }
  TableReader input = sensors.Table("strain_input");
  input.Read("converter_bits", &out->strain_input.converter_bits);
  input.Read("range_v", &out->strain_input.range_v);
  input.Read("filter_hz", &out->strain_input.filter_hz);
  if (input.Has("filter_damping")) input.Read("filter_damping", &out->strain_input.filter_damping);
  input.Read("noise_counts", &out->strain_input.noise_counts);
  if (sensors.Has("tip_accelerometer")) {
    ReadTipAccelerometer(sensors.Table("tip_accelerometer"), &out->tip_accelerometer.emplace());
  }
}

void ReadSim(TableReader sim, SimConfig* out) {
  sim.Read("plant_modes", &out->plant_modes);
  sim.Read("step_ms", &out->step_ms);
  sim.Read("seed", &out->seed);
  sim.Read("motor_lag_ms", &out->motor_lag_ms);
  sim.Read("transport_delay_ms", &out->transport_delay_ms);
  sim.Read("lost_frame_fraction", &out->lost_frame_fraction);
  sim.Read("channel_skew_us", &out->channel_skew_us);
  sim.Read("switch_angle_deg", &out->switch_angle_deg);
}

void ReadPayloadEstimator(TableReader payload, PayloadEstimatorConfig* out) {
  payload.Read("process_force", &out->process_force);
  payload.Read("rotor_extra_sigma_rad", &out->rotor_extra_sigma_rad);
  payload.Read("start_kg", &out->start_kg);
  payload.Read("start_sigma_kg", &out->start_sigma_kg);
  payload.Read("max_kg", &out->max_kg);
  payload.Read("move_sigma_kg", &out->move_sigma_kg);
  payload.Read("walk_kg", &out->walk_kg);
  payload.Read("min_rate_rad_s", &out->min_rate_rad_s);
  payload.Read("friction_start_sigma_nm", &out->friction_start_sigma_nm);
  payload.Read("friction_max_nm", &out->friction_max_nm);
  payload.Read("friction_walk_nm", &out->friction_walk_nm);
  payload.Read("friction_min_rate_rad_s", &out->friction_min_rate_rad_s);
  payload.Read("play_threshold_counts", &out->play_threshold_counts);
  payload.Read("play_memory", &out->play_memory);
  payload.Read("gate_sigmas", &out->gate_sigmas);
  if (payload.Has("tip_extra_sigma_m_s2")) {
    payload.Read("tip_extra_sigma_m_s2", &out->tip_extra_sigma_m_s2.emplace());
  }
  if (payload.Has("detect_delay")) payload.Read("detect_delay", &out->detect_delay);
}

void ReadEstimator(TableReader estimator, EstimatorConfig* out) {
  estimator.Read("name", &out->kind,
                 {{"kalman", EstimatorKind::kKalman},
                  {"difference", EstimatorKind::kDifference},
                  {"polynomial", EstimatorKind::kPolynomial},
                  {"ekf-payload", EstimatorKind::kPayload},
                  {"ideal", EstimatorKind::kIdeal}});
  estimator.Read("modes_per_link", &out->modes_per_link);
  estimator.Read("process_force", &out->process_force);
  estimator.Read("rotor_extra_sigma_rad", &out->rotor_extra_sigma_rad);
  estimator.Read("hub_extra_sigma_rad", &out->hub_extra_sigma_rad);
  estimator.Read("modal_sigma_m", &out->modal_sigma_m);
  estimator.Read("max_joint_rate_rad_s", &out->max_joint_rate_rad_s);
  estimator.Read("hub_rotor_limit_rad", &out->hub_rotor_limit_rad);
  estimator.Read("strain_family_limit", &out->strain_family_limit);
  estimator.Read("strain_stuck_limit", &out->strain_stuck_limit);
  estimator.Read("innovation_limit_rad", &out->innovation_limit_rad);
  estimator.Read("fault_ticks", &out->fault_ticks);
  if (estimator.Has("payload")) {
    ReadPayloadEstimator(estimator.Table("payload"), &out->payload.emplace());
  }
}

void ReadPayloadLaw(TableReader payload, PayloadLawConfig* out) {
  payload.Read("max_kg", &out->max_kg);
  payload.Read("reference_kg", &out->reference_kg);
  payload.Read("gain_payload_kg", &out->gain_payload_kg);
  payload.Read("gain_elbow_deg", &out->gain_elbow_deg);
}

void ReadPlan(TableReader plan, PlanAheadConfig* out) {
  plan.Read("moving_weight", &out->moving_weight);
  plan.Read("resting_weight", &out->resting_weight);
  plan.Read("torque_weight", &out->torque_weight);
  plan.Read("light_kg", &out->light_kg);
  plan.Read("torque_share", &out->torque_share);
  plan.Read("start_alpha", &out->start_alpha);
  plan.Read("every_periods", &out->every_periods);
  plan.Read("ready_periods", &out->ready_periods);
  plan.Read("rest_periods", &out->rest_periods);
  plan.Read("roughness", &out->roughness);
  plan.Read("payload_change_kg", &out->payload_change_kg);
  plan.Read("payload_change_share", &out->payload_change_share);
}

void ReadSettling(TableReader settling, SettlingConfig* out) {
  settling.Read("alpha", &out->alpha);
  settling.Read("payload_filter_below_mm", &out->payload_filter_below_mm);
  settling.Read("acts_below_mm", &out->acts_below_mm);
  settling.Read("hold_below_mm", &out->hold_below_mm);
  settling.Read("release_above_mm", &out->release_above_mm);
  settling.Read("process_force_share", &out->process_force_share);
  settling.Read("dead_band_counts", &out->dead_band_counts);
}

void ReadMatrices(TableReader matrices, GainMatrixConfig* out) {
  if (matrices.Has("T")) matrices.Read("T", &out->T);
  if (matrices.Has("Tbar")) matrices.Read("Tbar", &out->Tbar);
  if (matrices.Has("S")) matrices.Read("S", &out->S);
  if (matrices.Has("K_e")) matrices.Read("K_e", &out->K_e);
  if (matrices.Has("K_I0")) matrices.Read("K_I0", &out->K_I0);
}

void ReadController(TableReader controller, ControllerConfig* out) {
  std::vector<NamedValue<ControllerKind>> laws;
  laws.reserve(kLaws.size());
  for (const LawRow& law : kLaws) laws.push_back({law.name, law.kind});
  controller.Read("name", &out->kind, laws);
  controller.Read("nominal", &out->nominal,
                  {{"R12", kR12}, {"R8", kR8}, {"T12", kT12}, {"T16", kT16}});
  controller.Read("alpha", &out->alpha);
  controller.Read("vartheta", &out->vartheta);
  controller.Read("sigma", &out->sigma);
  controller.Read(
      "feedforward_sign", &out->feedforward_sign,
      {{"printed", FeedforwardSign::kPrinted}, {"corrected", FeedforwardSign::kCorrected}});
  controller.Read("hub_angle_weight", &out->hub_angle_weight);
  controller.Read("hub_rate_weight", &out->hub_rate_weight);
  if (controller.Has("state_weight")) controller.Read("state_weight", &out->state_weight);
  controller.Read("torque_weight", &out->torque_weight);
  controller.Read("passivity_margin", &out->passivity_margin);
  controller.Read("adaptation_gain", &out->adaptation_gain);
  controller.Read("adaptation_dead_zone_nm", &out->adaptation_dead_zone_nm);
  controller.Read("adaptation_bound", &out->adaptation_bound);
  controller.Read("pd_stiffness_nm_per_rad", &out->pd_stiffness_nm_per_rad);
  controller.Read("pd_damping_nms_per_rad", &out->pd_damping_nms_per_rad);
  controller.Read("payload_range_kg", &out->payload_range_kg);
  controller.Read("prediction", &out->prediction);
  controller.Read("adaptation", &out->adaptation);
  if (controller.Has("matrices")) {
    ReadMatrices(controller.Table("matrices"), &out->matrices.emplace());
  }
  if (controller.Has("payload")) {
    ReadPayloadLaw(controller.Table("payload"), &out->payload.emplace());
  }
  if (controller.Has("plan")) ReadPlan(controller.Table("plan"), &out->plan.emplace());
  if (controller.Has("settling")) {
    ReadSettling(controller.Table("settling"), &out->settling.emplace());
  }
  if (controller.Has("gains")) controller.Read("gains", &out->gains_file);
}

void ReadSafety(TableReader root, SafetyConfig* out) {
  TableReader limits = root.Table("limits");
  limits.Read("torque_limit_nm", &out->torque_limit_nm);
  limits.Read("slew_limit_nm_per_s", &out->slew_limit_nm_per_s);
  limits.Read("soft_angle_deg", &out->soft_angle_deg);
  limits.Read("hub_rate_rad_s", &out->hub_rate_rad_s);
  limits.Read("strain_limit", &out->strain_limit);
  limits.Read("plan_fraction", &out->plan_fraction);
  TableReader safety = root.Table("safety");
  safety.Read("rest_hub_rate_rad_s", &out->rest_hub_rate_rad_s);
  safety.Read("rest_strain_rate_per_s", &out->rest_strain_rate_per_s);
  safety.Read("rest_time_s", &out->rest_time_s);
  safety.Read("stop_timeout_s", &out->stop_timeout_s);
  safety.Read("fault_stop_s", &out->fault_stop_s);
  safety.Read("permit_timeout_ms", &out->permit_timeout_ms);
  safety.Read("missed_deadlines_to_trip", &out->missed_deadlines_to_trip);
  safety.Read("overrun_to_trip_ms", &out->overrun_to_trip_ms);
  safety.Read("window_periods", &out->window_periods);
  safety.Read("missed_deadlines_in_window", &out->missed_deadlines_in_window);
  safety.Read("failed_exchanges_in_window", &out->failed_exchanges_in_window);
  safety.Read("slow_exchanges_in_window", &out->slow_exchanges_in_window);
  safety.Read("homing_contact_s", &out->homing_contact_s);
  safety.Read("homing_torque_fraction", &out->homing_torque_fraction);
  safety.Read("prove_days", &out->prove_days);
  if (safety.Has("disarm_after_s")) safety.Read("disarm_after_s", &out->disarm_after_s);
}

void ReadCommissioning(TableReader commissioning, CommissioningConfig* out) {
  commissioning.Read("calibration_file", &out->calibration_file);
  commissioning.Read("angles_at_start", &out->angles_at_start,
                     {{"at_zero", AnglesAtStart::kAtZero},
                      {"absolute", AnglesAtStart::kAbsolute},
                      {"lost", AnglesAtStart::kLost}});
  commissioning.Read("prove_before_run", &out->prove_before_run);
  commissioning.Read("measure_s", &out->measure_s);
  commissioning.Read("pluck_torque_nm", &out->pluck_torque_nm);
  commissioning.Read("pluck_pulse_s", &out->pluck_pulse_s);
  commissioning.Read("pluck_rest_s", &out->pluck_rest_s);
  commissioning.Read("motion_tolerance", &out->motion_tolerance);
  commissioning.Read("gauge_tolerance", &out->gauge_tolerance);
  commissioning.Read("home_rate_deg_per_s", &out->home_rate_deg_per_s);
  commissioning.Read("home_travel_deg", &out->home_travel_deg);
  commissioning.Read("home_back_deg", &out->home_back_deg);
  commissioning.Read("switch_angle_deg", &out->switch_angle_deg);
}

CsvImport ReadCsvImport(TableReader csv) {
  std::vector<NamedValue<CsvUnit>> units;
  for (const CsvUnit& unit : kCsvUnits) units.push_back({unit.name, unit});
  CsvImport import{};
  if (csv.Has("separator")) {
    csv.Read<char>("separator", &import.separator,
                   {{",", ','}, {";", ';'}, {"tab", '\t'}, {"\t", '\t'}});
  }
  if (csv.Has("resample")) csv.Read("resample", &import.resample);
  if (csv.Has("longest_gap_s")) csv.Read("longest_gap_s", &import.longest_gap_s);
  if (!import.resample || csv.Has("decimation")) csv.Read("decimation", &import.decimation);
  for (TableReader row : csv.Rows("column")) {
    CsvColumn& column = import.column.emplace_back();
    row.Read("column", &column.column);
    row.Read("unit", &column.unit, units);
    row.Read("scale", &column.scale);
    if (row.Has("offset")) row.Read("offset", &column.offset);
    row.Read("target", &column.target);
  }
  return import;
}

void ReadLog(TableReader log, DaemonConfig* out) {
  log.Read("directory", &out->log_directory);
  if (log.Has("required")) log.Read("required", &out->log.required);
  if (log.Has("reserve_mb")) log.Read("reserve_mb", &out->log.reserve_mb);
  if (log.Has("keep_free_mb")) log.Read("keep_free_mb", &out->log.keep_free_mb);
  if (log.Has("keep_days")) log.Read("keep_days", &out->log.keep_days);
  if (log.Has("keep_total_mb")) log.Read("keep_total_mb", &out->log.keep_total_mb);
  if (log.Has("keep_trips")) log.Read("keep_trips", &out->log.keep_trips);
}

void ReadTiming(TableReader root, RigConfig* config) {
  TableReader loop = root.Table("loop");
  loop.Read("period_ms", &config->loop.period_ms);
  loop.Read("acquire_before_ms", &config->loop.acquire_before_ms);
  loop.Read("step_deadline_ms", &config->loop.step_deadline_ms);
  loop.Read("output", &config->loop.output,
            {{"next_tick", OutputTiming::kNextTick}, {"at_once", OutputTiming::kAtOnce}});
  loop.Read("output_after_ms", &config->loop.output_after_ms);
  loop.Read("actuation_delay_ms", &config->loop.actuation_delay_ms);
  TableReader daemon = root.Table("daemon");
  daemon.Read("socket", &config->daemon.socket);
  daemon.Read("state_directory", &config->daemon.state_directory);
  ReadLog(root.Table("log"), &config->daemon);
}

}  // namespace

void ReadTuningBasis(TableReader root, TuningBasis* basis) {
  ReadArm(root, &basis->arm);
  ReadSensors(root.Table("sensors"), &basis->sensors);
  double period_ms = 0.0;
  root.Table("loop").Read("period_ms", &period_ms);
  basis->period_s = 1e-3 * period_ms;
  TableReader limits = root.Table("limits");
  limits.Read("torque_limit_nm", &basis->torque_limit_nm);
  basis->strain_limit.fill(std::numeric_limits<double>::quiet_NaN());
  if (limits.Has("strain_limit")) limits.Read("strain_limit", &basis->strain_limit);
  root.Table("controller").Read("payload_range_kg", &basis->payload_range_kg);
}

void ReadRig(TableReader root, RigConfig* config) {
  root.Table("rig").Read("name", &config->rig_name);
  ReadArm(root, &config->arm);
  ReadSensors(root.Table("sensors"), &config->sensors);
  ReadSim(root.Table("sim"), &config->sim);
  ReadEstimator(root.Table("estimator"), &config->estimator);
  ReadController(root.Table("controller"), &config->controller);
  ReadSafety(root, &config->safety);
  ReadCommissioning(root.Table("commissioning"), &config->commissioning);
  ReadTiming(root, config);
  if (root.Has("csv")) config->csv = ReadCsvImport(root.Table("csv"));
  if (root.Has("hal")) {
    ReadHal(root.Table("hal"), config->loop.period_ms, &config->backend, &config->hal);
  }
}

}  // namespace flexarm
