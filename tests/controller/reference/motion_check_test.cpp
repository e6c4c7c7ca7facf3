// Every limit, with hand-made samples just within and just beyond it.

#include "controller/reference/motion_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

constexpr int kStates = 12;  // th1 th2 f11 f12 f21 f22 | rates

// Round numbers: torques of 10 and 5, friction 1 and 0.5, jumps of 4 x 50 x 0.02 = 4 and 2 N m.
constexpr MotionLimits kLimits = {.soft_angle_rad = {1.5, 1.0},
                                  .torque_nm = {10.0, 5.0},
                                  .slew_nm_per_s = {50.0, 25.0},
                                  .hub_rate_rad_s = {2.0, 3.0},
                                  .strain = {1e-3, 2e-3},
                                  .plan_fraction = 0.5,
                                  .fast_fraction = {},
                                  .fast_least_s = 0.0,
                                  .coulomb_friction_nm = {1.0, 0.5},
                                  .viscous_friction_nm_s_per_rad = {0.5, 0.25},
                                  .modes_per_link = 2,
                                  .root_strain_per_m = {{{0.01, 0.1}, {0.02, 0.2}}},
                                  .link_length_m = {0.8, 0.9}};

// Ten samples of which the fifth is filled.
std::vector<ReferenceSample> SamplesWith(const std::function<void(ReferenceSample*)>& fill) {
  std::vector<ReferenceSample> samples(10);
  fill(&samples[5]);
  return samples;
}

std::string Broken(const std::vector<ReferenceSample>& samples, double share = 1.0) {
  const auto broken =
      FirstBrokenLimit(samples, kStates, kLimits, LimitShares::Of(share), kPeriod_s);
  return broken ? broken->text : "none";
}

struct LimitCase {
  std::string name;
  std::function<void(ReferenceSample*, double)> fill;
  double limit;
  std::vector<std::string> said;
};

class MotionCheck : public testing::TestWithParam<LimitCase> {};

TEST_P(MotionCheck, JustWithinIsAcceptedAndJustBeyondIsNamed) {
  const LimitCase& c = GetParam();
  for (const double sign : {1.0, -1.0}) {
    const auto at = [&](double share) {
      return SamplesWith([&](ReferenceSample* s) { c.fill(s, sign * share * c.limit); });
    };
    EXPECT_EQ(Broken(at(0.999)), "none");
    const std::string text = Broken(at(1.001));
    for (const std::string& said : c.said) EXPECT_THAT(text, HasSubstr(said));
    EXPECT_THAT(text, HasSubstr("after 0.10 s"));
  }
}

const LimitCase kCases[] = {
    {"Angle1",
     [](auto* s, double v) { s->x_m[0] = v; },
     1.5,
     {"the angle of joint 1", "85.94 deg"}},
    {"Angle2", [](auto* s, double v) { s->x_m[1] = v; }, 1.0, {"the angle of joint 2"}},
    {"Rate1", [](auto* s, double v) { s->x_m[6] = v; }, 2.0, {"hub rate of joint 1", "2 rad/s"}},
    {"Rate2", [](auto* s, double v) { s->x_m[7] = v; }, 3.0, {"hub rate of joint 2"}},
    {"Jump1", [](auto* s, double v) { s->u_m_nm[0] = v; }, 4.0, {"jump", "joint 1", "4 N m"}},
    {"Jump2", [](auto* s, double v) { s->u_m_nm[1] = v; }, 2.0, {"jump", "joint 2", "2 N m"}},
    {"Strain1", [](auto* s, double v) { s->x_m[2] = v; }, 0.1, {"strain", "link 1", "1000 micro"}},
    {"Strain1b", [](auto* s, double v) { s->x_m[3] = v; }, 0.01, {"strain", "link 1"}},
    {"Strain2", [](auto* s, double v) { s->x_m[4] = v; }, 0.1, {"strain", "link 2", "2000 micro"}},
    {"Strain2b", [](auto* s, double v) { s->x_m[5] = v; }, 0.01, {"strain", "link 2"}},
};
INSTANTIATE_TEST_SUITE_P(All, MotionCheck, testing::ValuesIn(kCases),
                         [](const auto& c) { return c.param.name; });

std::vector<ReferenceSample> Ramp(double peak_nm, double rate_rad_s) {
  std::vector<ReferenceSample> samples(20);
  for (int k = 0; k < 20; ++k) {
    samples[static_cast<std::size_t>(k)].u_m_nm[0] = peak_nm * std::min(k, 19 - k) / 9.0;
    samples[static_cast<std::size_t>(k)].x_m[6] = rate_rad_s;
  }
  return samples;
}

// Of 10 N m, 1 N m are for Coulomb and 0.5 x 2 N m for viscous friction.
TEST(MotionCheckTorque, FrictionCountsTowardsTheLimit) {
  EXPECT_EQ(Broken(Ramp(8.99, 0.0)), "none");
  EXPECT_THAT(Broken(Ramp(9.01, 0.0)), HasSubstr("torque with friction of joint 1 reaches 10.01"));
  EXPECT_EQ(Broken(Ramp(-7.99, 2.0)), "none");
  EXPECT_THAT(Broken(Ramp(-8.01, 2.0)), HasSubstr("reaches -10.01 N m"));
}

// Part of a reference whose first sample is used only for the change of torque after it.
TEST(MotionCheckPart, CountsFromItsFirstSampleAndDoesNotCheckIt) {
  std::vector<ReferenceSample> samples(10);
  for (ReferenceSample& sample : samples) sample.u_m_nm[0] = 5.0;
  samples[0].x_m[0] = 2.0;
  EXPECT_FALSE(FirstBrokenLimit(samples, kStates, kLimits, LimitShares::Of(1.0), kPeriod_s, 30));
  samples[1].u_m_nm[0] = 0.9;
  const auto jump =
      FirstBrokenLimit(samples, kStates, kLimits, LimitShares::Of(1.0), kPeriod_s, 30);
  ASSERT_TRUE(jump.has_value());
  EXPECT_EQ(jump->sample, 31);
  EXPECT_THAT(jump->text, testing::AllOf(HasSubstr("a jump of the torque of joint 1 reaches -4.1"),
                                         HasSubstr("after 0.62 s")));
}

TEST(MotionCheckShare, AllLimitsButTheAngleAreScaledByTheShare) {
  EXPECT_EQ(Broken(SamplesWith([](auto* s) { s->x_m[0] = 1.4; }), 0.5), "none");
  EXPECT_THAT(Broken(SamplesWith([](auto* s) { s->x_m[6] = 1.01; }), 0.5), HasSubstr("1 rad/s"));
  EXPECT_EQ(Broken(SamplesWith([](auto* s) { s->x_m[6] = 0.99; }), 0.5), "none");
  EXPECT_NE(Broken(Ramp(4.1, 0.0), 0.5), "none");
  EXPECT_EQ(Broken(Ramp(3.9, 0.0), 0.5), "none");
}

}  // namespace
}  // namespace flexarm
