#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "config/config.h"
#include "tests/config/broken_text.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;

const BrokenText kContradiction[] = {
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
    {"MoreModesInTheModelThanCanBeDifferentiated",
     "name = \"kalman\"                 # laws that follow the payload use \"ekf-payload\" "
     "instead\n"
     "modes_per_link = 2",
     "name = \"difference\"\nmodes_per_link = 1", "controller.nominal",
     "has 2 modes a link: with this estimator.name, estimator.modes_per_link = 1",
     "nominal = \"R12\""},
    {"StateWeightOfAnotherModel", "torque_weight = 2.0",
     "torque_weight = 2.0\nstate_weight = [100, 20, 0, 0, 5, 1, 0, 0]", "controller.state_weight",
     "one weight for each state of controller.nominal: 12", "state_weight = [100"},
    {"RateAboveTheJump", "hub_rate_rad_s = [8.0, 10.0]", "hub_rate_rad_s = [8.0, 14.0]",
     "limits.hub_rate_rad_s[1]", "impossible jump"},
    {"RestAboveTheRateLimit", "hub_rate_rad_s = [8.0, 10.0]", "hub_rate_rad_s = [0.05, 10.0]",
     "safety.rest_hub_rate_rad_s", "limits.hub_rate_rad_s[0]", "rest_hub_rate_rad_s"},
    {"RestAboveTheReducedRate", "[safety]", "[safety]\nreduced_rate = 0.0055",
     "safety.reduced_rate", "must be above safety.rest_hub_rate_rad_s"},
    {"StopShorterThanRest", "stop_timeout_s = 4.0", "stop_timeout_s = 0.5", "safety.stop_timeout_s",
     "safety.rest_time_s = 0.5"},
    {"StopLongerThanTheServiceMayTake", "stop_timeout_s = 4.0", "stop_timeout_s = 12.0",
     "safety.stop_timeout_s", "the service ends within 15 s"},
    {"HoldReleasesBelow", "release_above_mm = 1.6", "release_above_mm = 1.0",
     "controller.settling.release_above_mm", "controller.settling.hold_below_mm = 1.1"},
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
                         NameOfCase);

TEST(BrokenConfigs, TooFewGaugesForTheModesAreReported) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  const std::size_t begin = text.find("# Link 1: the middles");
  const std::size_t end = text.find("# Link 2: the middles");
  text.replace(begin, end - begin,
               "[[sensors.strain]]\nlink = 1\nposition_m = 0.04\nface = 1\n"
               "gain_v_per_unit = 5000.0\noffset_counts = 0.0\n");
  ASSERT_EQ(ProblemsOf(text).size(), 1U);
  EXPECT_EQ(ProblemsOf(text)[0].key, "estimator.modes_per_link");
  // For one mode, one gauge at the clamp is enough.
  const std::string one = Replaced(text, "modes_per_link = 2", "modes_per_link = 1");
  EXPECT_TRUE(ProblemsOf(Replaced(one, "nominal = \"R12\"", "nominal = \"R8\"")).empty());
}

// The shipped arm with rho A and EI in place of the cross-section of link 2.
std::string WithIntegratedSection() {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  const std::size_t begin = text.find("area_m2 = 9.525e-5");
  text.replace(begin, text.find("half_thickness_m = 1.5875e-3") - begin,
               "mass_per_length_kg_m = 0.25784175\nbending_stiffness_nm2 = 5.5126890\n");
  return text;
}

TEST(BrokenConfigs, ASectionMayHaveMassPerLengthAndBendingStiffness) {
  EXPECT_TRUE(ProblemsOf(WithIntegratedSection()).empty());
  const ArmParameters arm = ParseConfig(WithIntegratedSection(), "text").arm;
  EXPECT_FALSE(arm.link[1].section[0].has_cross_section);
  EXPECT_EQ(arm.link[1].section[0].mass_per_length_kg_m(), 0.25784175);
  EXPECT_EQ(arm.link[1].section[0].bending_stiffness_nm2(), 5.512689);
  EXPECT_TRUE(arm.link[0].section[0].has_cross_section);
}

TEST(BrokenConfigs, ASectionHasOneFormNotBothAndNotNone) {
  const auto both = ProblemsOf(Replaced(FileText(Shipped("thesis-rig.toml")), "area_m2 = 9.525e-5",
                                        "bending_stiffness_nm2 = 5.5\narea_m2 = 9.525e-5"));
  ASSERT_EQ(both.size(), 1U);
  EXPECT_EQ(both[0].key, "link2.section[0].bending_stiffness_nm2");
  EXPECT_THAT(both[0].rule, HasSubstr("must not be given beside area_m2"));
  const std::string text = WithIntegratedSection();
  const auto half = ProblemsOf(Replaced(text, "bending_stiffness_nm2 = 5.5126890\n", ""));
  ASSERT_EQ(half.size(), 1U);
  EXPECT_EQ(half[0].key, "link2.section[0].bending_stiffness_nm2");
  const auto none = ProblemsOf(Replaced(Replaced(text, "bending_stiffness_nm2 = 5.5126890\n", ""),
                                        "mass_per_length_kg_m = 0.25784175\n", ""));
  ASSERT_EQ(none.size(), 1U);
  EXPECT_EQ(none[0].key, "link2.section[0].mass_per_length_kg_m");
  EXPECT_THAT(none[0].rule, HasSubstr("or the section has area_m2"));
  const auto negative = ProblemsOf(Replaced(text, "0.25784175", "-0.25784175"));
  ASSERT_EQ(negative.size(), 1U);
  EXPECT_EQ(negative[0].key, "link2.section[0].mass_per_length_kg_m");
}

TEST(BrokenConfigs, DampingAsPrintedNeedsTheCrossSection) {
  const auto problems =
      ProblemsOf(Replaced(WithIntegratedSection(), "damping = \"ca_rho\"", "damping = \"ca_lit\""));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].key, "arm.damping");
  EXPECT_THAT(problems[0].rule, HasSubstr("needs area_m2"));
}

TEST(BrokenConfigs, RotorEncodersMayBeAbsent) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  const std::size_t begin = text.find("[[sensors.encoder]]\njoint = \"rotor1\"");
  text.erase(begin, text.find("[sensors.strain_input]") - begin);
  EXPECT_TRUE(ProblemsOf(text).empty());
}

// Angles that are not measured cannot be differentiated; the Kalman filter estimates them.
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

TEST(BrokenConfigs, ALawThatEstimatesThePayloadNeedsItsTables) {
  const auto without = [](const std::string& law, const std::string& table) {
    return ProblemsOf(Replaced(Replaced(FileText(Shipped("thesis-rig.toml")), "name = \"sobel\"",
                                        "name = \"" + law + "\""),
                               "[" + table + "]  ", "[rig2]  "));
  };
  const auto refused = [](const std::vector<ConfigProblem>& problems, const std::string& table) {
    return std::any_of(problems.begin(), problems.end(), [&](const ConfigProblem& problem) {
      return problem.key == "controller.name" && problem.rule == "needs the table [" + table + "]";
    });
  };
  const std::string payload = "controller.payload", plan = "controller.plan";
  EXPECT_FALSE(refused(without("gain-scheduled", payload), payload)) << "it is derived";
  EXPECT_FALSE(refused(without("receding-horizon", payload), payload)) << "it is derived";
  EXPECT_TRUE(refused(without("receding-horizon", plan), plan));
  EXPECT_FALSE(refused(without("gain-scheduled", plan), plan)) << "this law has no planner";
}

TEST(BrokenConfigs, AHardwareRigHasNoTipAccelerometer) {
  const std::vector<ConfigProblem> problems = ProblemsFrom([] {
    LoadConfig(Shipped("daq-rig.toml"),
               {"sensors.tip_accelerometer={range_m_s2=50, converter_bits=14, noise_counts=4, "
                "filter_hz=200}",
                "estimator.payload.tip_extra_sigma_m_s2=0.5"});
  });
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].key, "sensors.tip_accelerometer");
  EXPECT_THAT(problems[0].rule, HasSubstr("hal.backend = \"wired\""));
}

}  // namespace
}  // namespace flexarm
