#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/config.h"
#include "tests/config/broken_text.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;

const BrokenText kRange[] = {
    {"EmptyName", "name = \"thesis-rig\"", "name = \"\"", "rig.name", "must name the rig"},
    {"NegativeLength", "length_m = 0.8", "length_m = -0.8", "link1.section[0].length_m",
     "must be positive"},
    {"NegativePayload", "payload_mass_kg = 0.1 ", "payload_mass_kg = -0.1 ", "arm.payload_mass_kg",
     "must not be negative"},
    {"DampingRatioOfOne", "damping_ratio = 0.03", "damping_ratio = 1.0", "link1.damping_ratio",
     "0 <= xi < 1"},
    {"TwoEncodersOnAJoint", "joint = \"rotor2\"", "joint = \"rotor1\" # again",
     "sensors.encoder[3].joint", "an angle has one encoder"},
    {"NoEncoderOnAHub",
     "[[sensors.encoder]]\njoint = \"hub2\"\ncounts_per_turn = 2540.0\ncounter_bits = 8\nsign = 1",
     "", "sensors.encoder", "joint = \"hub2\"", "[[sensors.encoder]]"},
    {"TooFewCounts", "counts_per_turn = 2540.0", "counts_per_turn = 0.0",
     "sensors.encoder[0].counts_per_turn", "100 .. 1e+08"},
    {"TooManyBits", "counter_bits = 16", "counter_bits = 33", "sensors.encoder[3].counter_bits",
     "4 .. 32"},
    {"ZeroSign", "sign = 1", "sign = 0", "sensors.encoder[0].sign", "must be 1, or -1"},
    {"OneBitConverter", "converter_bits = 12", "converter_bits = 1",
     "sensors.strain_input.converter_bits", "8 .. 24"},
    {"NegativeNoise", "noise_counts = 1.0", "noise_counts = -1.0",
     "sensors.strain_input.noise_counts", "0 .. 10000"},
    {"NegativeFilter", "filter_hz = 20.0", "filter_hz = -20.0", "sensors.strain_input.filter_hz",
     "0 for none"},
    {"OverdampedFilter", "filter_hz = 20.0", "filter_hz = 20.0\nfilter_damping = 5.0",
     "sensors.strain_input.filter_damping", "0.1 .. 2", "filter_damping = 5.0"},
    {"NegativeViscousFriction", "viscous_friction_nm_s_per_rad = 0.0",
     "viscous_friction_nm_s_per_rad = -0.1", "joint1.viscous_friction_nm_s_per_rad",
     "must not be negative"},
    {"ForeignCsvWithoutColumns", "[loop]", "[csv]\ndecimation = 5\n[loop]", "csv.column", "missing",
     "[csv]"},
    {"ThirdLink", "link = 1", "link = 3", "sensors.strain[0].link", "the arm has two links"},
    {"GaugeBeyondTheLink", "position_m = 0.2\n", "position_m = 0.81\n",
     "sensors.strain[2].position_m", "link 1 is 0.8 m long", "position_m = 0.81"},
    {"GaugeBeforeTheLink", "position_m = 0.2\n", "position_m = -0.2\n",
     "sensors.strain[2].position_m", "must be 0 or more", "position_m = -0.2"},
    {"ZeroFace", "face = 1", "face = 0", "sensors.strain[0].face", "must be 1"},
    {"ZeroGain", "gain_v_per_unit = 5000.0", "gain_v_per_unit = 0.0",
     "sensors.strain[0].gain_v_per_unit", "must not be 0"},
    {"OffsetAtTheRail", "offset_counts = 0.0", "offset_counts = 2047.0",
     "sensors.strain[0].offset_counts", "the converter's range"},
    {"StepThatDoesNotDivide", "step_ms = 0.5", "step_ms = 0.3", "sim.step_ms", "divide 1 ms"},
    {"NoPlantModes", "plant_modes = 4", "plant_modes = 0", "sim.plant_modes", "1 .. 6"},
    {"LongTransport", "transport_delay_ms = 0.0", "transport_delay_ms = 41.0",
     "sim.transport_delay_ms", "0 .. 40"},
    {"TooManyLostFrames", "lost_frame_fraction = 0.0", "lost_frame_fraction = 0.6",
     "sim.lost_frame_fraction", "0 .. 0.5"},
    {"NegativeLag", "motor_lag_ms = [2.0, 2.0]", "motor_lag_ms = [2.0, -2.0]",
     "sim.motor_lag_ms[1]", "0 .. 100"},
    {"ThreeModes", "modes_per_link = 2", "modes_per_link = 3", "estimator.modes_per_link",
     "1 .. 2"},
    {"NoProcessNoise", "process_force = [0.3, 0.05, 5.0", "process_force = [0.3, 0.05, 0.0",
     "estimator.process_force[2]", "above 0"},
    {"LateFault", "fault_ticks = 3", "fault_ticks = 4", "estimator.fault_ticks", "three ticks"},
    {"AlphaBeyondTen", "alpha = 3.0", "alpha = 10.5", "controller.alpha", "0 .. 10"},
    {"VarthetaBeyondOne", "vartheta = 0.35", "vartheta = 1.01", "controller.vartheta", "0 .. 1"},
    {"NegativeLeak", "sigma = 0.02", "sigma = -0.02", "controller.sigma", "0 .. 1"},
    {"NoAngleWeight", "hub_angle_weight = [100.0, 20.0]", "hub_angle_weight = [100.0, 0.0]",
     "controller.hub_angle_weight[1]", "double integrator"},
    {"UnknownNominalModel", "nominal = \"R12\"", "nominal = \"R16\"", "controller.nominal",
     "one of \"R12\" \"R8\" \"T12\" \"T16\""},
    {"NoWeightOnAHub", "torque_weight = 2.0",
     "torque_weight = 2.0\nstate_weight = [100, 0, 0, 0, 0, 0, 5, 1, 0, 0, 0, 0]",
     "controller.state_weight[1]", "double integrator", "state_weight = [100"},
    {"NegativeStateWeight", "torque_weight = 2.0",
     "torque_weight = 2.0\nstate_weight = [100, 20, 0, 0, -1, 0, 5, 1, 0, 0, 0, 0]",
     "controller.state_weight[4]", "never negative", "state_weight = [100"},
    {"EmptyStateWeight", "torque_weight = 2.0", "torque_weight = 2.0\nstate_weight = []",
     "controller.state_weight", "array of finite numbers", "state_weight = []"},
    {"NoPassivityMargin", "passivity_margin = 5.0", "passivity_margin = 0.0",
     "controller.passivity_margin", "must exceed J"},
    {"NoPdStiffness", "pd_stiffness_nm_per_rad = [30.0, 1.0]",
     "pd_stiffness_nm_per_rad = [30.0, 0.0]", "controller.pd_stiffness_nm_per_rad[1]", "above 0"},
    {"NegativePdDamping", "pd_damping_nms_per_rad = [0.5, 0.3]",
     "pd_damping_nms_per_rad = [-0.5, 0.3]", "controller.pd_damping_nms_per_rad[0]", "negative"},
    {"PayloadBelowNothing", "payload_range_kg = [0.0, 1.0]", "payload_range_kg = [-0.1, 1.0]",
     "controller.payload_range_kg[0]", "0 .. 100"},
    {"GreatestPayloadFirst", "payload_range_kg = [0.0, 1.0]", "payload_range_kg = [1.0, 0.5]",
     "controller.payload_range_kg", "the least payload, then the greatest"},
    {"StartsBeyondItsHeaviestPayload", "start_kg = 0.5 ", "start_kg = 1.2 ",
     "estimator.payload.start_kg", "at most estimator.payload.max_kg = 1.1"},
    {"NoDoubtOfThePayload", "start_sigma_kg = 0.4", "start_sigma_kg = 0.0",
     "estimator.payload.start_sigma_kg", "never estimated"},
    {"PlayIsNeverForgotten", "play_memory = 0.999", "play_memory = 1.999",
     "estimator.payload.play_memory", "0 .. 1"},
    {"FastBeyondTheLimits", "fast_fraction = [0.72, 0.62]", "fast_fraction = [0.72, 1.62]",
     "controller.payload.fast_fraction[1]", "at most 1"},
    {"MovesOfNoTime", "fast_least_s = 0.56", "fast_least_s = 0.0",
     "controller.payload.fast_least_s", "above 0"},
    {"GainsNotAscending", "gain_payload_kg = [0.0, 0.05, 0.1,",
     "gain_payload_kg = [0.0, 0.1, 0.05,", "controller.payload.gain_payload_kg", "ascending"},
    {"GainsNotFromZero", "gain_elbow_deg = [0.0, 20.0,", "gain_elbow_deg = [10.0, 20.0,",
     "controller.payload.gain_elbow_deg[0]", "the first is 0"},
    {"NoTorque", "torque_limit_nm = [30.0, 6.0]", "torque_limit_nm = [30.0, 0.0]",
     "limits.torque_limit_nm[1]", "above 0"},
    {"StrainOfTenPercent", "strain_limit = [1.9e-3, 1.9e-3]", "strain_limit = [0.1, 1.9e-3]",
     "limits.strain_limit[0]", "0.01"},
    {"PlansBeyondTheLimits", "plan_fraction = 0.6", "plan_fraction = 1.1", "limits.plan_fraction",
     "at most 1"},
    {"LongPermit", "permit_timeout_ms = 5.0", "permit_timeout_ms = 50.0",
     "safety.permit_timeout_ms", "2 .. 20"},
    {"NeverMissed", "missed_deadlines_to_trip = 3", "missed_deadlines_to_trip = 0",
     "safety.missed_deadlines_to_trip", "1 .. 10"},
    {"ArmedForWeeks", "# disarm_after_s = 600.0", "disarm_after_s = 1e6", "safety.disarm_after_s",
     "0 .. 86400"},
    {"NothingReserved", "[log]\n", "[log]\nreserve_mb = 0.0\n", "log.reserve_mb", "0.1 .. ",
     "reserve_mb = 0.0"},
    {"LessThanNothingFree", "[log]\n", "[log]\nkeep_free_mb = -1.0\n", "log.keep_free_mb", "0 .. ",
     "keep_free_mb = -1.0"},
    {"KeptForLessThanADay", "[log]\n", "[log]\nkeep_days = -1.0\n", "log.keep_days", "0 .. 36525",
     "keep_days = -1.0"},
    {"LessThanNothingKept", "[log]\n", "[log]\nkeep_total_mb = -1.0\n", "log.keep_total_mb",
     "0 .. ", "keep_total_mb = -1.0"},
    {"ProofForEver", "prove_days = 90.0", "prove_days = 4000.0", "safety.prove_days", "1 .. 366"},
    {"OverrunNeverTrips", "overrun_to_trip_ms = 5.0", "overrun_to_trip_ms = 0.0",
     "safety.overrun_to_trip_ms", "2 .. 1000"},
    {"OverrunInDays", "overrun_to_trip_ms = 5.0", "overrun_to_trip_ms = 1e9",
     "safety.overrun_to_trip_ms", "2 .. 1000"},
    {"WindowTooLong", "window_periods = 200", "window_periods = 257", "safety.window_periods",
     "10 .. 256"},
    {"MissedDeadlinesNeverTrip", "missed_deadlines_in_window = 16",
     "missed_deadlines_in_window = 201", "safety.missed_deadlines_in_window", "1 .. 200"},
    {"FailedExchangesNeverTrip", "failed_exchanges_in_window = 16",
     "failed_exchanges_in_window = 0", "safety.failed_exchanges_in_window", "1 .. 200"},
    {"SlowExchangesNeverTrip", "slow_exchanges_in_window = 16", "slow_exchanges_in_window = 0",
     "safety.slow_exchanges_in_window", "1 .. 200"},
    {"DeadBandOfACount", "dead_band_counts = 0.2", "dead_band_counts = 1.0",
     "controller.settling.dead_band_counts", "0 .. 0.5"},
    {"ShortPeriod", "period_ms = 20.0", "period_ms = 0.5", "loop.period_ms", "1 .. 100"},
    {"LongPeriod", "period_ms = 20.0", "period_ms = 101.0", "loop.period_ms", "1 .. 100"},
    {"LongSocket", "flexarmd.sock", std::string(107, 'x'), "daemon.socket", "107 bytes"},
    {"SocketWithAVariable", "/run/flexarm", "$HOME", "daemon.socket", "not expanded"},
    {"NoStateDirectory", "state_directory = \"runs\"", "state_directory = \"\"",
     "daemon.state_directory", "a trip"},
    {"NoLogDirectory", "[log]\ndirectory = \"runs\"", "[log]\ndirectory = \"\"", "log.directory",
     "run logs"},
};
INSTANTIATE_TEST_SUITE_P(Range, BrokenConfig, ::testing::ValuesIn(kRange), NameOfCase);

const BrokenText kPlan[] = {
    {"PlanNeverMade", "every_periods = 10", "every_periods = 0", "controller.plan.every_periods",
     "1 .. 100"},
    {"PlanReadyAtOnce", "ready_periods = 5", "ready_periods = 1", "controller.plan.ready_periods",
     "2 .. 20"},
    {"PlanOfFreeTorque", "torque_weight = [0.02, 0.2]", "torque_weight = [0.02, 0.0]",
     "controller.plan.torque_weight[1]", "does not limit the torque"},
    {"PlanBeyondTheLimits", "torque_share = 0.93", "torque_share = 1.1",
     "controller.plan.torque_share", "reserved for the feedback"},
};
INSTANTIATE_TEST_SUITE_P(Plan, BrokenConfig, ::testing::ValuesIn(kPlan), NameOfCase);

TEST(BrokenConfigs, TooManyStrainChannelsAreReported) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  for (int i = 0; i < 13; ++i) {
    text +=
        "[[sensors.strain]]\nlink = 2\nposition_m = 0.1\nface = -1\ngain_v_per_unit = 5000.0\n"
        "offset_counts = 0.0\n";
  }
  ASSERT_EQ(ProblemsOf(text).size(), 1U);
  EXPECT_EQ(ProblemsOf(text)[0].key, "sensors.strain");
  EXPECT_EQ(ProblemsOf(text)[0].value, "33 rows");
}

// A rig with a tip accelerometer.
std::string WithTipAccelerometer() {
  return Replaced(Replaced(FileText(Shipped("thesis-rig.toml")), "[sim]",
                           "[sensors.tip_accelerometer]\nrange_m_s2 = 50.0\nconverter_bits = 14\n"
                           "noise_counts = 4.0\nfilter_hz = 200.0\n\n[sim]"),
                  "gate_sigmas = 4.0", "gate_sigmas = 4.0\ntip_extra_sigma_m_s2 = 0.5");
}

TEST(BrokenConfigs, AFaultyTipAccelerometerIsReportedOnce) {
  const std::string rig = WithTipAccelerometer();
  EXPECT_TRUE(ProblemsOf(rig).empty());
  const std::string table = "sensors.tip_accelerometer";
  const BrokenText cases[] = {
      {"NoRange", "range_m_s2 = 50.0", "range_m_s2 = 0.0", table + ".range_m_s2", "1 .. 10000"},
      {"ThirtyBits", "converter_bits = 14", "converter_bits = 30", table + ".converter_bits",
       "8 .. 24"},
      {"NegativeNoise", "noise_counts = 4.0", "noise_counts = -4.0", table + ".noise_counts",
       "0 .. 10000"},
      {"SlowFilter", "filter_hz = 200.0", "filter_hz = 50.0", table + ".filter_hz", "100 .. 1e+05"},
      {"NegativeExtra", "tip_extra_sigma_m_s2 = 0.5", "tip_extra_sigma_m_s2 = -0.5",
       "estimator.payload.tip_extra_sigma_m_s2", "0 .. 1000"},
      {"NoExtra", "tip_extra_sigma_m_s2 = 0.5", "", table, "estimator.payload.tip_extra_sigma_m_s2",
       "[sensors.tip_accelerometer]"},
      {"UnknownKey", "range_m_s2 = 50.0", "range_m_s2 = 50.0\nrange_g = 5.0", table + ".range_g",
       "unknown key", "range_g = 5.0"},
  };
  for (const BrokenText& c : cases) {
    SCOPED_TRACE(c.name);
    const std::string text = c.Edit(rig);
    ExpectReportedOnce(c, text, "rig.toml", ProblemsOf(text));
  }
  const std::vector<ConfigProblem> missing = ProblemsOf(Replaced(rig, "noise_counts = 4.0\n", ""));
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].key, table + ".noise_counts");
  EXPECT_THAT(missing[0].rule, HasSubstr("missing"));
}

}  // namespace
}  // namespace flexarm
