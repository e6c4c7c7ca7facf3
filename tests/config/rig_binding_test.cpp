#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>

#include "config/config.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

// Every key of a section gets a value that no other key of its type has, so that a value in the
// wrong field is detected.
TEST(RigBinding, PutsEveryKeyOfTheArmInItsField) {
  const ArmParameters arm =
      HilWith({"arm.hub2_mass_kg=1", "arm.motor2_mass_kg=2", "arm.motor2_inertia_kgm2=3",
               "arm.payload_mass_kg=4", "arm.payload_inertia_kgm2=5", "arm.shape_payload_mass_kg=6",
               "arm.foreshortening=true", "joint2.backlash_rad=0.07",
               "joint2.backlash_model=thesis", "joint2.restitution_slope_s_per_rad=0.08"})
          .arm;
  EXPECT_EQ(arm.hub2_mass_kg, 1.0);
  EXPECT_EQ(arm.motor2_mass_kg, 2.0);
  EXPECT_EQ(arm.motor2_inertia_kgm2, 3.0);
  EXPECT_EQ(arm.payload_mass_kg, 4.0);
  EXPECT_EQ(arm.payload_inertia_kgm2, 5.0);
  EXPECT_EQ(arm.shape_payload_mass_kg, 6.0);
  EXPECT_TRUE(arm.foreshortening);
  EXPECT_EQ(arm.joint2_backlash.clearance_rad, 0.07);
  EXPECT_EQ(arm.joint2_backlash.model, BacklashModel::kThesis);
  EXPECT_EQ(arm.joint2_backlash.restitution_slope_s_per_rad, 0.08);
}

TEST(RigBinding, PutsEveryKeyOfTheSensorsInItsField) {
  const SensorConfig s =
      HilWith({"sensors.encoder[1].sign=-1", "sensors.encoder[1].counter_bits=9",
               "sensors.encoder[1].counts_per_turn=2541", "sensors.strain[11].position_m=0.2",
               "sensors.strain[11].face=-1", "sensors.strain[11].gain_v_per_unit=4000",
               "sensors.strain[11].offset_counts=7", "sensors.strain_input.converter_bits=13",
               "sensors.strain_input.range_v=11", "sensors.strain_input.filter_hz=21",
               "sensors.strain_input.noise_counts=2", "sensors.strain_input.filter_damping=0.7"})
          .sensors;
  for (std::size_t i = 0; i < s.encoder.size(); ++i) {
    EXPECT_EQ(s.encoder[i].counter, static_cast<int>(i));
  }
  EXPECT_EQ(s.encoder[1].sign, -1);
  EXPECT_EQ(s.encoder[1].counter_bits, 9);
  EXPECT_EQ(s.encoder[1].counts_per_turn, 2541.0);
  EXPECT_EQ(s.strain[11].link, 2);
  EXPECT_EQ(s.strain[11].position_m, 0.2);
  EXPECT_EQ(s.strain[11].face, -1);
  EXPECT_EQ(s.strain[11].gain_v_per_unit, 4000.0);
  EXPECT_EQ(s.strain[11].offset_counts, 7.0);
  EXPECT_EQ(s.strain_input.converter_bits, 13);
  EXPECT_EQ(s.strain_input.range_v, 11.0);
  EXPECT_EQ(s.strain_input.filter_hz, 21.0);
  EXPECT_EQ(s.strain_input.noise_counts, 2.0);
  EXPECT_EQ(s.strain_input.filter_damping, 0.7);
  EXPECT_EQ(HilWith({}).sensors.strain_input.filter_damping,
            0.0);  // without the key the filter is of first order
}

TEST(RigBinding, PutsEveryKeyOfATipAccelerometerInItsField) {
  EXPECT_FALSE(HilWith({}).sensors.tip_accelerometer.has_value());
  EXPECT_FALSE(HilWith({}).estimator.payload->tip_extra_sigma_m_s2.has_value());
  const RigConfig rig =
      HilWith({"sensors.tip_accelerometer={range_m_s2=40, converter_bits=15, "
               "noise_counts=3, filter_hz=250}",
               "estimator.payload.tip_extra_sigma_m_s2=0.7"});
  const TipAccelerometerConfig& tip = rig.sensors.tip_accelerometer.value();
  EXPECT_EQ(tip.range_m_s2, 40.0);
  EXPECT_EQ(tip.converter_bits, 15);
  EXPECT_EQ(tip.noise_counts, 3.0);
  EXPECT_EQ(tip.filter_hz, 250.0);
  EXPECT_EQ(tip.m_s2_per_count(), 80.0 / 32768.0);
  EXPECT_EQ(tip.lowest_count(), -16384);
  EXPECT_EQ(tip.highest_count(), 16383);
  EXPECT_DOUBLE_EQ(tip.lag_s(), 1.0 / (2.0 * std::numbers::pi * 250.0));
  EXPECT_EQ(rig.estimator.payload->tip_extra_sigma_m_s2, 0.7);
}

TEST(RigBinding, PutsEveryKeyOfAForeignCsvInItsField) {
  EXPECT_FALSE(HilWith({}).csv.has_value());
  const RigConfig rig =
      LoadConfig(Shipped("quanser-2dsfl.toml"), {"csv.column[3].offset=0.25", "csv.decimation=5"});
  ASSERT_TRUE(rig.csv.has_value());
  EXPECT_EQ(rig.csv->decimation, 5);
  ASSERT_EQ(rig.csv->column.size(), 7U);
  const CsvColumn& torque = rig.csv->column[3];
  EXPECT_EQ(torque.column, "motor1_current_a");
  EXPECT_EQ(torque.unit.si, 1.0);
  EXPECT_EQ(torque.scale, 8.925);
  EXPECT_EQ(torque.offset, 0.25);
  EXPECT_EQ(torque.target, "torque_1");
  EXPECT_DOUBLE_EQ(rig.csv->column[1].unit.si * 180.0, std::numbers::pi);  // degrees
  EXPECT_EQ(rig.csv->column[0].offset, 0.0);                               // without the key
  EXPECT_THROW(LoadConfig(Shipped("quanser-2dsfl.toml"), {"csv.column[0].unit=parsec"}),
               ConfigError);
  EXPECT_THROW(LoadConfig(Shipped("quanser-2dsfl.toml"), {"csv.column[0].target=hub3"}),
               ConfigError);
}

// A search over parameters does this many times.
TEST(RigBinding, ANumberIsReadAndReplacedByItsKey) {
  const RigConfig rig = HilWith({});
  EXPECT_EQ(NumberAt(rig, "link1.section[0].length_m"), 0.8);
  EXPECT_EQ(NumberAt(rig, "sensors.encoder[3].counter_bits"), 16.0);
  EXPECT_EQ(NumberAt(rig, "limits.soft_angle_deg[1]"), 90.0);
  for (const char* none : {"rig.name", "link1.section", "link3.length_m", "arm.nothing", ""}) {
    EXPECT_FALSE(NumberAt(rig, none).has_value()) << none;
  }
  const RigConfig other = WithOverrides(rig, {"link1.section[0].length_m=0.83"});
  EXPECT_EQ(other.arm.link[0].section[0].length_m, 0.83);
  EXPECT_EQ(WithOverrides(other, {"link1.section[0].length_m=0.8"}).text, rig.text);
  EXPECT_THROW(WithOverrides(rig, {"link1.section[0].length_m=-1"}), ConfigError);
}

TEST(RigBinding, PutsEveryKeyOfTheSimulationInItsField) {
  const SimConfig sim =
      HilWith({"sim.plant_modes=3", "sim.step_ms=0.25", "sim.seed=12", "sim.motor_lag_ms=[4, 5]",
               "sim.transport_delay_ms=6", "sim.lost_frame_fraction=0.07", "sim.channel_skew_us=8",
               "sim.switch_angle_deg=[97, 98]"})
          .sim;
  EXPECT_EQ(sim.plant_modes, 3);
  EXPECT_EQ(sim.step_ms, 0.25);
  EXPECT_EQ(sim.seed, 12U);
  EXPECT_EQ(sim.motor_lag_ms, (std::array{4.0, 5.0}));
  EXPECT_EQ(sim.transport_delay_ms, 6.0);
  EXPECT_EQ(sim.lost_frame_fraction, 0.07);
  EXPECT_EQ(sim.channel_skew_us, 8.0);
  EXPECT_EQ(sim.switch_angle_deg, (std::array{97.0, 98.0}));
}

TEST(RigBinding, PutsEveryKeyOfTheEstimatorInItsField) {
  const EstimatorConfig e =
      LoadConfig(Shipped("thesis-rig.toml"),
                 {"estimator.modes_per_link=1", "controller.nominal=R8", "estimator.fault_ticks=2"})
          .estimator;
  EXPECT_EQ(e.modes_per_link, 1);
  EXPECT_EQ(e.fault_ticks, 2);
  const EstimatorConfig set =
      HilWith({"estimator.process_force=[1, 2, 3, 4, 5, 6]",
               "estimator.rotor_extra_sigma_rad=[0.01, 0.02]",
               "estimator.hub_extra_sigma_rad=[0.03, 0.04]",
               "estimator.modal_sigma_m=[0.01, 0.02, 0.03, 0.04]",
               "estimator.max_joint_rate_rad_s=15", "estimator.hub_rotor_limit_rad=0.11",
               "estimator.strain_family_limit=0.005", "estimator.strain_stuck_limit=0.006",
               "estimator.innovation_limit_rad=0.36"})
          .estimator;
  EXPECT_EQ(set.process_force, (std::array{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_EQ(set.rotor_extra_sigma_rad, (std::array{0.01, 0.02}));
  EXPECT_EQ(set.hub_extra_sigma_rad, (std::array{0.03, 0.04}));
  EXPECT_EQ(set.modal_sigma_m, (std::array{0.01, 0.02, 0.03, 0.04}));
  EXPECT_EQ(set.max_joint_rate_rad_s, 15.0);
  EXPECT_EQ(set.hub_rotor_limit_rad, 0.11);
  EXPECT_EQ(set.strain_family_limit, 0.005);
  EXPECT_EQ(set.strain_stuck_limit, 0.006);
  EXPECT_EQ(set.innovation_limit_rad, 0.36);
}

TEST(RigBinding, PutsEveryKeyOfThePayloadTablesInItsField) {
  const RigConfig set = HilWith({"estimator.payload.process_force=[1, 2, 3, 4, 5, 6]",
                                 "estimator.payload.rotor_extra_sigma_rad=[0.01, 0.02]",
                                 "estimator.payload.start_kg=0.3",
                                 "estimator.payload.start_sigma_kg=0.5",
                                 "estimator.payload.max_kg=1.2",
                                 "estimator.payload.move_sigma_kg=0.6",
                                 "estimator.payload.walk_kg=0.004",
                                 "estimator.payload.min_rate_rad_s=0.05",
                                 "estimator.payload.friction_start_sigma_nm=[0.2, 0.3]",
                                 "estimator.payload.friction_max_nm=[2, 3]",
                                 "estimator.payload.friction_walk_nm=[0.4, 0.5]",
                                 "estimator.payload.friction_min_rate_rad_s=0.06",
                                 "estimator.payload.play_threshold_counts=2.5",
                                 "estimator.payload.play_memory=0.9",
                                 "estimator.payload.gate_sigmas=5",
                                 "estimator.payload.detect_delay=false",
                                 "controller.payload.max_kg=0.9",
                                 "controller.payload.fast_fraction=[0.5, 0.4]",
                                 "controller.payload.fast_least_s=0.7",
                                 "controller.payload.reference_kg=0.25",
                                 "controller.payload.gain_payload_kg=[0, 0.5]",
                                 "controller.payload.gain_elbow_deg=[0, 45, 90]",
                                 "estimator.name=ekf-payload",
                                 "controller.name=gain-scheduled"});
  EXPECT_EQ(set.estimator.kind, EstimatorKind::kPayload);
  EXPECT_EQ(set.controller.kind, ControllerKind::kGainScheduled);
  const PayloadEstimatorConfig& e = set.estimator.payload.value();
  EXPECT_EQ(e.process_force, (std::array{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_EQ(e.rotor_extra_sigma_rad, (std::array{0.01, 0.02}));
  EXPECT_EQ(e.start_kg, 0.3);
  EXPECT_EQ(e.start_sigma_kg, 0.5);
  EXPECT_EQ(e.max_kg, 1.2);
  EXPECT_EQ(e.move_sigma_kg, 0.6);
  EXPECT_EQ(e.walk_kg, 0.004);
  EXPECT_EQ(e.min_rate_rad_s, 0.05);
  EXPECT_EQ(e.friction_start_sigma_nm, (std::array{0.2, 0.3}));
  EXPECT_EQ(e.friction_max_nm, (std::array{2.0, 3.0}));
  EXPECT_EQ(e.friction_walk_nm, (std::array{0.4, 0.5}));
  EXPECT_EQ(e.friction_min_rate_rad_s, 0.06);
  EXPECT_EQ(e.play_threshold_counts, 2.5);
  EXPECT_EQ(e.play_memory, 0.9);
  EXPECT_EQ(e.gate_sigmas, 5.0);
  EXPECT_FALSE(e.detect_delay);
  const PayloadLawConfig& c = set.controller.payload.value();
  EXPECT_EQ(c.max_kg, 0.9);
  EXPECT_EQ(c.fast_fraction, (std::array{0.5, 0.4}));
  EXPECT_EQ(c.fast_least_s, 0.7);
  EXPECT_EQ(c.reference_kg, 0.25);
  EXPECT_EQ(c.gain_payload_kg, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(c.gain_elbow_deg, (std::vector<double>{0, 45, 90}));
}

TEST(RigBinding, PutsEveryKeyOfSettlingInItsField) {
  const SettlingConfig s =
      HilWith({"controller.settling.alpha=1.5", "controller.settling.payload_filter_below_mm=2.5",
               "controller.settling.acts_below_mm=3.5", "controller.settling.hold_below_mm=4.5",
               "controller.settling.release_above_mm=5.5",
               "controller.settling.process_force_share=[1, 2, 3, 4, 5, 6]",
               "controller.settling.dead_band_counts=0.45"})
          .controller.settling.value();
  EXPECT_EQ(s.alpha, 1.5);
  EXPECT_EQ(s.payload_filter_below_mm, 2.5);
  EXPECT_EQ(s.acts_below_mm, 3.5);
  EXPECT_EQ(s.hold_below_mm, 4.5);
  EXPECT_EQ(s.release_above_mm, 5.5);
  EXPECT_EQ(s.process_force_share, (std::array{1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
  EXPECT_EQ(s.dead_band_counts, 0.45);
}

// Where `sobel` cannot bring the arm to rest it is `sobel-thesis`, for the reason that it names.
TEST(Settling, IsNamedWhereItIsNotPossible) {
  EXPECT_TRUE(HilWith({}).settles());
  EXPECT_FALSE(HilWith({"controller.name=sobel-thesis"}).settles());
  struct Case {
    const char* override;
    const char* reason;
  };
  for (const auto& [override, reason] :
       {Case{"estimator.name=difference", "kalman"}, Case{"controller.nominal=T12", "R12"}}) {
    const RigConfig config = HilWith({override});
    EXPECT_FALSE(config.settles()) << override;
    EXPECT_FALSE(config.uses_payload_estimator()) << override;
    EXPECT_THAT(config.why_not_settling(), testing::HasSubstr(reason)) << override;
  }
  RigConfig config = HilWith({});
  config.controller.payload.reset();
  EXPECT_THAT(config.why_not_settling(), testing::HasSubstr("[controller.payload]"));
  config.controller.settling.reset();
  EXPECT_THAT(config.why_not_settling(), testing::HasSubstr("[controller.settling]"));
}

TEST(RigBinding, PutsEveryKeyOfTheControllerInItsField) {
  const ControllerConfig c =
      HilWith({"controller.alpha=0.1", "controller.vartheta=0.2", "controller.sigma=0.3",
               "controller.hub_angle_weight=[4, 5]", "controller.hub_rate_weight=[6, 7]",
               "controller.torque_weight=8", "controller.passivity_margin=9",
               "controller.adaptation_gain=10", "controller.prediction=false",
               "controller.adaptation_dead_zone_nm=0.5", "controller.adaptation_bound=0.7",
               "controller.pd_stiffness_nm_per_rad=[11, 12]",
               "controller.pd_damping_nms_per_rad=[13, 14]", "controller.nominal=T12",
               "controller.payload_range_kg=[0.1, 0.6]",
               "controller.state_weight=[1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3]"})
          .controller;
  EXPECT_EQ(c.nominal, kT12);
  EXPECT_EQ(c.state_weight, (std::vector<double>{1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3}));
  EXPECT_EQ(c.alpha, 0.1);
  EXPECT_EQ(c.vartheta, 0.2);
  EXPECT_EQ(c.sigma, 0.3);
  EXPECT_EQ(c.hub_angle_weight, (std::array{4.0, 5.0}));
  EXPECT_EQ(c.hub_rate_weight, (std::array{6.0, 7.0}));
  EXPECT_EQ(c.torque_weight, 8.0);
  EXPECT_EQ(c.passivity_margin, 9.0);
  EXPECT_EQ(c.adaptation_gain, 10.0);
  EXPECT_EQ(c.adaptation_dead_zone_nm, 0.5);
  EXPECT_EQ(c.adaptation_bound, 0.7);
  EXPECT_EQ(c.pd_stiffness_nm_per_rad, (std::array{11.0, 12.0}));
  EXPECT_EQ(c.pd_damping_nms_per_rad, (std::array{13.0, 14.0}));
  EXPECT_EQ(c.payload_range_kg, (std::array{0.1, 0.6}));
  EXPECT_TRUE(HilWith({}).controller.state_weight.empty());
  for (const NamedLayout& model : kNominalModels) {
    EXPECT_EQ(HilWith({"controller.nominal=" + std::string(model.name)}).controller.nominal,
              model.layout);
  }
  EXPECT_FALSE(c.prediction);
  EXPECT_TRUE(c.adaptation);
  EXPECT_EQ(c.gains_file, "");
}

TEST(RigBinding, PutsEveryLimitInItsField) {
  const SafetyConfig s = HilWith({"limits.torque_limit_nm=[1, 2]",
                                  "limits.slew_limit_nm_per_s=[3, 4]",
                                  "limits.soft_angle_deg=[5, 6]",
                                  "limits.hub_rate_rad_s=[7, 8]",
                                  "limits.strain_limit=[1e-4, 2e-4]",
                                  "limits.plan_fraction=0.7",
                                  "limits.following_error_deg=[9, 10]",
                                  "safety.rest_hub_rate_rad_s=0.1",
                                  "safety.rest_strain_rate_per_s=0.2",
                                  "safety.rest_time_s=0.3",
                                  "safety.stop_timeout_s=0.4",
                                  "safety.permit_timeout_ms=6",
                                  "safety.missed_deadlines_to_trip=4",
                                  "safety.homing_torque_fraction=0.25",
                                  "safety.overrun_to_trip_ms=7",
                                  "safety.window_periods=30",
                                  "safety.missed_deadlines_in_window=11",
                                  "safety.failed_exchanges_in_window=12",
                                  "safety.slow_exchanges_in_window=13",
                                  "safety.prove_days=14",
                                  "safety.disarm_after_s=15"})
                             .safety;
  EXPECT_EQ(s.torque_limit_nm, (std::array{1.0, 2.0}));
  EXPECT_EQ(s.slew_limit_nm_per_s, (std::array{3.0, 4.0}));
  EXPECT_EQ(s.soft_angle_deg, (std::array{5.0, 6.0}));
  EXPECT_EQ(s.hub_rate_rad_s, (std::array{7.0, 8.0}));
  EXPECT_EQ(s.strain_limit, (std::array{1e-4, 2e-4}));
  EXPECT_EQ(s.plan_fraction, 0.7);
  EXPECT_EQ(s.following_error_deg, (std::optional{std::array{9.0, 10.0}}));
  EXPECT_EQ(s.rest_hub_rate_rad_s, 0.1);
  EXPECT_EQ(s.rest_strain_rate_per_s, 0.2);
  EXPECT_EQ(s.rest_time_s, 0.3);
  EXPECT_EQ(s.stop_timeout_s, 0.4);
  EXPECT_EQ(s.permit_timeout_ms, 6.0);
  EXPECT_EQ(s.missed_deadlines_to_trip, 4);
  EXPECT_EQ(s.overrun_to_trip_ms, 7.0);
  EXPECT_EQ(s.window_periods, 30);
  EXPECT_EQ(s.missed_deadlines_in_window, 11);
  EXPECT_EQ(s.failed_exchanges_in_window, 12);
  EXPECT_EQ(s.slow_exchanges_in_window, 13);
  EXPECT_EQ(s.homing_torque_fraction, 0.25);
  EXPECT_EQ(s.prove_days, 14.0);
  EXPECT_EQ(s.disarm_after_s, 15.0);
}

TEST(RigBinding, PutsTimesAndPathsInTheirFields) {
  const RigConfig c =
      HilWith({"loop.period_ms=18", "loop.acquire_before_ms=9", "loop.step_deadline_ms=4",
               "loop.output=at_once", "loop.output_after_ms=14", "loop.actuation_delay_ms=3",
               "daemon.socket=/tmp/s", "daemon.state_directory=/tmp/k", "log.directory=/tmp/d",
               "log.required=false", "log.reserve_mb=2", "log.keep_free_mb=3", "log.keep_days=4",
               "log.keep_total_mb=5", "log.keep_trips=false"});
  EXPECT_EQ(c.loop.period_ms, 18.0);
  EXPECT_EQ(c.loop.acquire_before_ms, 9.0);
  EXPECT_EQ(c.loop.step_deadline_ms, 4.0);
  EXPECT_EQ(c.loop.output, OutputTiming::kAtOnce);
  EXPECT_EQ(c.loop.output_after_ms, 14.0);
  EXPECT_EQ(c.loop.actuation_delay_ms, 3.0);
  EXPECT_EQ(HilWith({}).loop.output, OutputTiming::kNextTick);
  EXPECT_EQ(c.daemon.socket, "/tmp/s");
  EXPECT_EQ(c.daemon.state_directory, "/tmp/k");
  EXPECT_EQ(c.daemon.log_directory, "/tmp/d");
  EXPECT_FALSE(c.daemon.log.required);
  EXPECT_EQ(c.daemon.log.reserve_mb, 2.0);
  EXPECT_EQ(c.daemon.log.keep_free_mb, 3.0);
  EXPECT_EQ(c.daemon.log.keep_days, 4.0);
  EXPECT_EQ(c.daemon.log.keep_total_mb, 5.0);
  EXPECT_FALSE(c.daemon.log.keep_trips);
}

TEST(RigBinding, KnowsEveryNamedChoice) {
  const auto damping = [](const char* name) {
    return HilWith({std::string("arm.damping=") + name}).arm.damping;
  };
  EXPECT_EQ(damping("none"), DampingReading::kNone);
  EXPECT_EQ(damping("ca_rho"), DampingReading::kCurvatureRho);
  EXPECT_EQ(damping("ca_lit"), DampingReading::kCurvatureAsPrinted);
  EXPECT_EQ(damping("modal"), DampingReading::kModal);
  const auto inertia = [](const char* name) {
    return HilWith({std::string("arm.link1_tip_inertia=") + name}).arm.link1_tip_inertia;
  };
  EXPECT_EQ(inertia("motor"), Link1TipInertia::kMotor);
  EXPECT_EQ(inertia("motor_and_rotor"), Link1TipInertia::kMotorAndRotor);
  EXPECT_EQ(HilWith({}).estimator.kind, EstimatorKind::kKalman);
  EXPECT_EQ(HilWith({"estimator.name=difference"}).estimator.kind, EstimatorKind::kDifference);
  EXPECT_EQ(HilWith({"estimator.name=polynomial"}).estimator.kind, EstimatorKind::kPolynomial);
  EXPECT_EQ(HilWith({}).controller.kind, ControllerKind::kSobel);
  EXPECT_EQ(HilWith({"controller.name=lqr-cgt"}).controller.kind, ControllerKind::kLqrCgt);
  EXPECT_EQ(HilWith({"controller.name=sobel-original"}).controller.kind,
            ControllerKind::kSobelOriginal);
  EXPECT_EQ(HilWith({"controller.name=lqr-um"}).controller.kind, ControllerKind::kLqrUm);
  EXPECT_EQ(HilWith({"controller.name=lqg"}).controller.kind, ControllerKind::kLqg);
  EXPECT_EQ(HilWith({"controller.name=pd"}).controller.kind, ControllerKind::kPd);
  EXPECT_EQ(HilWith({"controller.name=pd-zv"}).controller.kind, ControllerKind::kPdZv);
  EXPECT_EQ(HilWith({"controller.name=pd-zvd"}).controller.kind, ControllerKind::kPdZvd);
  EXPECT_EQ(HilWith({}).controller.feedforward_sign, FeedforwardSign::kPrinted);
  EXPECT_EQ(HilWith({"controller.feedforward_sign=corrected"}).controller.feedforward_sign,
            FeedforwardSign::kCorrected);
}

TEST(RigBinding, KnowsEveryLineOfASimEvent) {
  const char* names[] = {"limit-1-low",  "limit-1-high",   "limit-2-low",
                         "limit-2-high", "emergency-stop", "reset-button"};
  for (int i = 0; i < kLines; ++i) {
    const Experiment e =
        ParseExperiment(std::string("name = \"x\"\nduration_s = 1\n[[sim_event]]\nat_s = 0\n"
                                    "level = 1\nline = \"") +
                            names[i] + "\"\n",
                        "e.toml");
    EXPECT_EQ(e.sim_event.at(0).line, static_cast<Line>(i)) << names[i];
    EXPECT_EQ(e.sim_event.at(0).level, 1);
  }
}

}  // namespace
}  // namespace flexarm
