#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/config.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;

// One edit of thesis-rig.toml that makes one problem.
struct BrokenCase {
  std::string name;
  std::string from;  // the first of these in the file ...
  std::string to;    // ... becomes this
  std::string key;   // the key that is reported
  std::string rule;  // a part of what is said
  // A text whose line is reported: that of `to` (its last line) unless given.
  std::string line_of = {};
};

void PrintTo(const BrokenCase& c, std::ostream* out) { *out << c.name; }

class BrokenConfig : public ::testing::TestWithParam<BrokenCase> {};

TEST_P(BrokenConfig, IsReportedOnceWithLineKeyAndRule) {
  const BrokenCase& c = GetParam();
  const std::string text = Replaced(FileText(Shipped("thesis-rig.toml")), c.from, c.to);
  const std::vector<ConfigProblem> problems = ProblemsOf(text);
  ASSERT_FALSE(problems.empty()) << "was accepted";
  for (std::size_t i = 1; i < problems.size(); ++i) ADD_FAILURE() << problems[i].Text();
  EXPECT_EQ(problems[0].file, "rig.toml");
  EXPECT_EQ(problems[0].line, LineOf(text, c.line_of.empty() ? c.to : c.line_of));
  EXPECT_EQ(problems[0].key, c.key);
  EXPECT_THAT(problems[0].rule, HasSubstr(c.rule));
}

std::string CaseName(const ::testing::TestParamInfo<BrokenCase>& info) { return info.param.name; }

const BrokenCase kForm[] = {
    {"UnknownKey", "alpha = 3.0", "alpa = 3.0", "controller.alpa",
     "did you mean \"alpha\", which is missing?"},
    {"UnknownKeyBesideTheRightOne", "sigma = 0.02", "sigma = 0.02\nsigmas = 0.02",
     "controller.sigmas", "did you mean \"sigma\"?"},
    {"UnknownSection", "[loop]", "[printer]\nx = 1\n[loop]", "printer",
     "unknown key; known here: extends rig", "[printer]"},
    {"KeyOfAnotherSection", "[safety]", "[safety]\nsoft_angle_deg = [90.0, 90.0]",
     "safety.soft_angle_deg", "did you mean limits.soft_angle_deg?"},
    {"UnknownKeyInARow", "joint = \"rotor2\"", "joint = \"rotor2\"\ngear = 48.96",
     "sensors.encoder[3].gear", "unknown key"},
    {"MissingKey", "period_ms = 20.0", "", "loop.period_ms", "missing", "[loop]"},
    {"MissingSection", "[daemon]\nsocket = \"/run/flexarm/flexarmd.sock\"", "", "daemon",
     "missing: must be there and be a table, [daemon]", "no line"},
    {"DuplicateKey", "sign = 1", "sign = 1\nsign = -1", "", "cannot redefine existing integer"},
    {"DuplicateSection", "[loop]", "[safety] # again\n[loop]", "", "cannot redefine", "# again"},
    {"NotToml", "[loop]", "[loop", "", "is not valid TOML"},
    {"TextForANumber", "alpha = 3.0", "alpha = \"3.0\"", "controller.alpha", "a finite number"},
    {"FractionForAWholeNumber", "fault_ticks = 3", "fault_ticks = 2.5", "estimator.fault_ticks",
     "a whole number"},
    {"NumberForText", "name = \"thesis-rig\"", "name = 7", "rig.name", "a string"},
    {"NumberForABoolean", "prediction = true", "prediction = 1", "controller.prediction",
     "true or false"},
    {"NumberForAPair", "motor_lag_ms = [2.0, 2.0]", "motor_lag_ms = 2.0", "sim.motor_lag_ms",
     "an array of 2 finite numbers"},
    {"ThreeNumbersForAPair", "motor_lag_ms = [2.0, 2.0]", "motor_lag_ms = [2.0, 2.0, 2.0]",
     "sim.motor_lag_ms", "an array of 2 finite numbers"},
    {"TextInAPair", "motor_lag_ms = [2.0, 2.0]", "motor_lag_ms = [2.0, \"2\"]",
     "sim.motor_lag_ms[1]", "a finite number"},
    {"TableForRows", "[[link1.section]]", "[link1.section]", "link1.section", "rows, each"},
    {"ValueForASection", "[loop]", "[log2]\n[loop]", "log2", "did you mean \"log\"", "[log2]"},
    {"NotANumber", "alpha = 3.0", "alpha = nan", "controller.alpha", "a finite number"},
    {"Infinite", "length_m = 0.8", "length_m = inf", "link1.section[0].length_m",
     "a finite number"},
    {"HugeSeed", "seed = 1", "seed = 18446744073709551616", "", "is not valid TOML"},
    {"NegativeSeed", "seed = 1", "seed = -1", "sim.seed", "0 or above"},
    {"UnknownDamping", "damping = \"ca_rho\"", "damping = \"ca\"", "arm.damping",
     "\"none\" \"ca_rho\" \"ca_lit\" \"modal\""},
    {"UnknownController", "name = \"sobel\"", "name = \"pid\"", "controller.name", "one of"},
    {"UnknownEstimator", "name = \"kalman\"", "name = \"luenberger\"", "estimator.name", "one of"},
    {"UnknownBackend", "[loop]", "[hal]\nbackend = \"comedi\"\n[loop]", "hal.backend",
     "must be one of \"sim\"", "[hal]\nbackend = "},
    {"BackendSectionWithoutBackend", "[loop]", "[hal]\n[loop]", "hal.backend", "missing", "[hal]"},
    {"ExtendsInAText", "[rig]", "extends = \"other.toml\"\n[rig]", "extends",
     "must stand in a rig's own file", "extends = "},
};
INSTANTIATE_TEST_SUITE_P(Form, BrokenConfig, ::testing::ValuesIn(kForm), CaseName);

const BrokenCase kRange[] = {
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
     "sensors.strain[0].offset_counts", "rails"},
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
    {"StartsBeyondItsHeaviestPayload", "start_kg = 0.2 ", "start_kg = 1.2 ",
     "estimator.payload.start_kg", "at most estimator.payload.max_kg = 1.1"},
    {"NoDoubtOfThePayload", "start_sigma_kg = 0.4", "start_sigma_kg = 0.0",
     "estimator.payload.start_sigma_kg", "never found"},
    {"PlayIsNeverForgotten", "play_memory = 0.999", "play_memory = 1.999",
     "estimator.payload.play_memory", "0 .. 1"},
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
    {"ShortPeriod", "period_ms = 20.0", "period_ms = 4.0", "loop.period_ms", "5 .. 100"},
    {"LongPeriod", "period_ms = 20.0", "period_ms = 101.0", "loop.period_ms", "5 .. 100"},
    {"LongSocket", "flexarmd.sock", std::string(107, 'x'), "daemon.socket", "107 bytes"},
    {"SocketWithAVariable", "/run/flexarm", "$HOME", "daemon.socket", "not expanded"},
    {"NoLogDirectory", "directory = \"runs\"", "directory = \"\"", "log.directory", "run logs"},
};
INSTANTIATE_TEST_SUITE_P(Range, BrokenConfig, ::testing::ValuesIn(kRange), CaseName);

const BrokenCase kPlan[] = {
    {"PlanNeverMade", "every_periods = 10", "every_periods = 0", "controller.plan.every_periods",
     "1 .. 100"},
    {"PlanReadyAtOnce", "ready_periods = 5", "ready_periods = 1", "controller.plan.ready_periods",
     "2 .. 20"},
    {"PlanOfFreeTorque", "torque_weight = [0.02, 0.2]", "torque_weight = [0.02, 0.0]",
     "controller.plan.torque_weight[1]", "any torque"},
    {"PlanBeyondTheLimits", "torque_share = 0.93", "torque_share = 1.1",
     "controller.plan.torque_share", "left to the feedback"},
};
INSTANTIATE_TEST_SUITE_P(Plan, BrokenConfig, ::testing::ValuesIn(kPlan), CaseName);

const BrokenCase kContradiction[] = {
    {"PayloadLawOnAnotherModel", "name = \"sobel\"\nnominal = \"R12\"",
     "name = \"gain-scheduled\"\nnominal = \"T16\"", "controller.name",
     "needs controller.nominal = \"R12\"", "name = \"gain-scheduled\""},
    {"OutputBeforeTheDeadline",
     "output = \"next_tick\"            # torque acts at the next sampling instant; \"at_once\": "
     "docs/timing.md\noutput_after_ms = 15.0",
     "output = \"at_once\"\noutput_after_ms = 12.0", "loop.output_after_ms", "15 .. 20"},
    {"UnknownOutput", "output = \"next_tick\"", "output = \"later\"", "loop.output",
     "must be one of \"next_tick\" \"at_once\""},
    {"ActuationBeyondTwoPeriods", "actuation_delay_ms = 0.0", "actuation_delay_ms = 41.0",
     "loop.actuation_delay_ms", "at most two periods"},
    {"TransportBetweenMilliseconds", "transport_delay_ms = 0.0", "transport_delay_ms = 0.5",
     "sim.transport_delay_ms", "whole milliseconds"},
    {"SkewBeyondTheStep", "channel_skew_us = 0.0", "channel_skew_us = 500.0", "sim.channel_skew_us",
     "sampled 2 ms before the step is due"},
    {"DeadlineBeyondThePeriod", "acquire_before_ms = 10.0", "acquire_before_ms = 15.0",
     "loop.step_deadline_ms", "15 + 5 < 20", "step_deadline_ms"},
    {"SoftAngleAtTheSwitch", "soft_angle_deg = [90.0, 90.0]", "soft_angle_deg = [90.0, 95.0]",
     "limits.soft_angle_deg[1]", "sim.switch_angle_deg[1] = 95"},
    {"CounterTooNarrow", "max_joint_rate_rad_s = 14.0", "max_joint_rate_rad_s = 15.9",
     "estimator.max_joint_rate_rad_s", "sensors.encoder[0] (8 bits)"},
    {"CounterOfAnotherBitWidth", "counter_bits = 16", "counter_bits = 11",
     "estimator.max_joint_rate_rad_s", "sensors.encoder[3] (11 bits)", "max_joint_rate_rad_s = 14"},
    {"MoreModesInTheModelThanInTheFit", "modes_per_link = 2", "modes_per_link = 1",
     "controller.nominal", "has 2 modes a link: estimator.modes_per_link = 1", "nominal = \"R12\""},
    {"StateWeightOfAnotherModel", "torque_weight = 2.0",
     "torque_weight = 2.0\nstate_weight = [100, 20, 0, 0, 5, 1, 0, 0]", "controller.state_weight",
     "one for each state of controller.nominal: 12", "state_weight = [100"},
    {"RateAboveTheJump", "hub_rate_rad_s = [8.0, 10.0]", "hub_rate_rad_s = [8.0, 14.0]",
     "limits.hub_rate_rad_s[1]", "impossible jump"},
    {"RestAboveTheRateLimit", "hub_rate_rad_s = [8.0, 10.0]", "hub_rate_rad_s = [0.05, 10.0]",
     "safety.rest_hub_rate_rad_s", "limits.hub_rate_rad_s[0]", "rest_hub_rate_rad_s"},
    {"StopShorterThanRest", "stop_timeout_s = 3.0", "stop_timeout_s = 0.5", "safety.stop_timeout_s",
     "safety.rest_time_s = 0.5"},
    {"TorqueBelowFriction", "torque_limit_nm = [30.0, 6.0]", "torque_limit_nm = [0.16, 6.0]",
     "limits.torque_limit_nm[0]", "joint1.coulomb_friction_nm = 0.16"},
    {"StrainTripAboveFullScale", "strain_limit = [1.9e-3, 1.9e-3]", "strain_limit = [1.9e-3, 2e-3]",
     "limits.strain_limit[1]", "sensors.strain[10]"},
    {"FamilyLimitInTheNoise", "strain_family_limit = 4e-4", "strain_family_limit = 3e-6",
     "estimator.strain_family_limit", "four times the noise"},
    {"PeriodOffTheGrid", "period_ms = 20.0", "period_ms = 20.2", "loop.period_ms",
     "sim.step_ms = 0.5"},
};
INSTANTIATE_TEST_SUITE_P(Contradiction, BrokenConfig, ::testing::ValuesIn(kContradiction),
                         CaseName);

TEST(BrokenConfigs, TooFewGaugesForTheModes) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  const std::size_t begin = text.find("# Link 1: the middles");
  const std::size_t end = text.find("# Link 2: the middles");
  text.replace(begin, end - begin,
               "[[sensors.strain]]\nlink = 1\nposition_m = 0.04\nface = 1\n"
               "gain_v_per_unit = 5000.0\noffset_counts = 0.0\n");
  ASSERT_EQ(ProblemsOf(text).size(), 1U);
  EXPECT_EQ(ProblemsOf(text)[0].key, "estimator.modes_per_link");
  // One gauge at the clamp is enough for one mode.
  const std::string one = Replaced(text, "modes_per_link = 2", "modes_per_link = 1");
  EXPECT_TRUE(ProblemsOf(Replaced(one, "nominal = \"R12\"", "nominal = \"R8\"")).empty());
}

// Differences of angles that nobody measures are none; the Kalman filter infers them.
TEST(BrokenConfigs, ATorsionalModelWithoutRotorEncodersNeedsTheKalmanFilter) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  const std::size_t begin = text.rfind("[[sensors.encoder]]");
  text.erase(begin, text.find("sign = 1", begin) + 8 - begin);  // rotor 2
  text = Replaced(text, "nominal = \"R12\"", "nominal = \"T12\"");
  EXPECT_TRUE(ProblemsOf(text).empty());
  const auto problems = ProblemsOf(Replaced(text, "name = \"kalman\"", "name = \"difference\""));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].key, "controller.nominal");
  EXPECT_THAT(problems[0].rule, HasSubstr("an encoder on each rotor"));
}

TEST(BrokenConfigs, ALawThatFindsThePayloadNeedsItsTables) {
  const auto without = [](const std::string& law, const std::string& table) {
    return ProblemsOf(Replaced(Replaced(FileText(Shipped("thesis-rig.toml")), "name = \"sobel\"",
                                        "name = \"" + law + "\""),
                               "[" + table + "]  ", "[rig2]  "));
  };
  const auto told = [](const std::vector<ConfigProblem>& problems, const std::string& table) {
    return std::any_of(problems.begin(), problems.end(), [&](const ConfigProblem& problem) {
      return problem.key == "controller.name" && problem.rule == "needs the table [" + table + "]";
    });
  };
  const std::string payload = "controller.payload", plan = "controller.plan";
  EXPECT_TRUE(told(without("gain-scheduled", payload), payload));
  EXPECT_TRUE(told(without("receding-horizon", payload), payload));
  EXPECT_TRUE(told(without("receding-horizon", plan), plan));
  EXPECT_FALSE(told(without("gain-scheduled", plan), plan)) << "it plans nothing";
}

// A rig with the sensor, and what may be wrong with it.
std::string WithTipAccelerometer() {
  return Replaced(Replaced(FileText(Shipped("thesis-rig.toml")), "[sim]",
                           "[sensors.tip_accelerometer]\nrange_m_s2 = 50.0\nconverter_bits = 14\n"
                           "noise_counts = 4.0\nfilter_hz = 200.0\n\n[sim]"),
                  "gate_sigmas = 4.0", "gate_sigmas = 4.0\ntip_extra_sigma_m_s2 = 0.5");
}

TEST(BrokenConfigs, OfATipAccelerometerAreReportedOnce) {
  const std::string rig = WithTipAccelerometer();
  EXPECT_TRUE(ProblemsOf(rig).empty());
  const std::string table = "sensors.tip_accelerometer";
  const BrokenCase cases[] = {
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
  for (const BrokenCase& c : cases) {
    const std::string text = Replaced(rig, c.from, c.to);
    const std::vector<ConfigProblem> problems = ProblemsOf(text);
    ASSERT_EQ(problems.size(), 1U) << c.name;
    EXPECT_EQ(problems[0].key, c.key);
    EXPECT_EQ(problems[0].line, LineOf(text, c.line_of.empty() ? c.to : c.line_of)) << c.name;
    EXPECT_THAT(problems[0].rule, HasSubstr(c.rule));
  }
  const std::vector<ConfigProblem> missing = ProblemsOf(Replaced(rig, "noise_counts = 4.0\n", ""));
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].key, table + ".noise_counts");
  EXPECT_THAT(missing[0].rule, HasSubstr("missing"));
}

TEST(BrokenConfigs, AWiredRigHasNoTipAccelerometer) {
  try {
    LoadConfig(Shipped("daq-rig.toml"),
               {"sensors.tip_accelerometer={range_m_s2=50, converter_bits=14, noise_counts=4, "
                "filter_hz=200}",
                "estimator.payload.tip_extra_sigma_m_s2=0.5"});
    FAIL() << "was accepted";
  } catch (const ConfigError& error) {
    ASSERT_EQ(error.problems().size(), 1U);
    EXPECT_EQ(error.problems()[0].key, "sensors.tip_accelerometer");
    EXPECT_THAT(error.problems()[0].rule, HasSubstr("hal.backend = \"wired\""));
  }
}

TEST(BrokenConfigs, TooManyStrainChannels) {
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

TEST(BrokenConfigs, RotorEncodersMayBeAbsent) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  const std::size_t begin = text.find("[[sensors.encoder]]\njoint = \"rotor1\"");
  text.erase(begin, text.find("[sensors.strain_input]") - begin);
  EXPECT_TRUE(ProblemsOf(text).empty());
}

TEST(BrokenConfigs, AreReportedAllAtOnceInOrderOfLine) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  text = Replaced(text, "length_m = 0.8", "length_m = -0.8");                  // out of range
  text = Replaced(text, "counter_bits = 16", "counter_bits = \"16\"");         // mistyped
  text = Replaced(text, "alpha = 3.0", "alfa = 3.0");                          // unknown
  text = Replaced(text, "soft_angle_deg = [90.0", "soft_angle_deg = [100.0");  // contradictory
  text = Replaced(text, "period_ms = 20.0", "");                               // missing
  try {
    ParseConfig(text, "rig.toml");
    FAIL() << "was accepted";
  } catch (const ConfigError& error) {
    std::vector<std::string> keys;
    for (const ConfigProblem& p : error.problems()) keys.push_back(p.key);
    EXPECT_THAT(keys, ::testing::ElementsAre("link1.section[0].length_m",
                                             "sensors.encoder[3].counter_bits", "controller.alfa",
                                             "limits.soft_angle_deg[0]", "loop.period_ms"));
    const std::string what = error.what();
    EXPECT_EQ(std::count(what.begin(), what.end(), '\n'), 4);  // five lines
    EXPECT_THAT(what, HasSubstr("rig.toml:" + std::to_string(LineOf(text, "length_m = -0.8")) +
                                ": link1.section[0].length_m = -0.8: must be positive\n"));
  }
}

// Every key of the file in turn, so that none can be forgotten by the reader.
class EveryKey : public ::testing::Test {
 protected:
  // The file with its line `i` edited.
  template <typename Edit>
  void ForEachKeyLine(Edit edit) {
    const std::string text = FileText(Shipped("thesis-rig.toml"));
    int keys = 0;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = text.find('\n', begin);
      const std::string line = text.substr(begin, end - begin);
      const std::size_t equals = line.find(" = ");
      if (equals != std::string::npos && line[0] != '#') {
        ++keys;
        std::string edited = text;
        edited.replace(begin, line.size(), edit(line, line.substr(0, equals)));
        Check(ProblemsOf(edited), line, line.substr(0, equals),
              1 + static_cast<int>(std::count(
                      text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n')));
      }
      begin = end + 1;
    }
    EXPECT_GT(keys, 180);
  }

  virtual void Check(const std::vector<ConfigProblem>& problems, const std::string& line,
                     const std::string& key, int number) {
    ASSERT_EQ(problems.size(), 1U) << number << ": " << line;
    EXPECT_THAT(problems[0].key, HasSubstr(key)) << problems[0].Text();
    EXPECT_THAT(problems[0].rule, HasSubstr(expected_)) << problems[0].Text();
    EXPECT_TRUE(!same_line_ || problems[0].line == number) << problems[0].Text();
  }

  std::string expected_;
  bool same_line_ = true;
};

TEST_F(EveryKey, IsMissedByName) {
  expected_ = "missing";
  same_line_ = false;
  ForEachKeyLine([](const std::string&, const std::string&) { return std::string(); });
}

TEST_F(EveryKey, IsRefusedWithAValueOfTheWrongType) {
  expected_ = "must be";
  ForEachKeyLine([](const std::string&, const std::string& key) { return key + " = 1979-05-27"; });
}

TEST_F(EveryKey, IsSuggestedWhenMisspelt) {
  expected_ = "which is missing?";
  ForEachKeyLine([](const std::string& line, const std::string& key) {
    return key + "x" + line.substr(key.size());
  });
}

}  // namespace
}  // namespace flexarm
