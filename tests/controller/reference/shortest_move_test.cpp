// The fewest periods in which a move keeps its limits: at the ends of the search range, and where
// only few durations are feasible. That the result fits, and a period less does not: move_test.cpp
// and retarget_move_test.cpp.

#include "controller/reference/shortest_move.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "controller/reference/path_reference.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/reference/no_limits.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

PlannedMove FromRest(double from_rad, double to_rad, int periods = 0, int first = 0) {
  PlannedMove move{.row = 0,
                   .first = first,
                   .periods = periods,
                   .retargets = false,
                   .from = {},
                   .to_rad = {to_rad, 0.0},
                   .profile = MoveProfile::kSeptic};
  move.from.angle_rad[0] = from_rad;
  return move;
}

// With a move of the shoulder that retargets it at a sample.
std::vector<PlannedMove> TakenOver(const PlannedMove& out, int first, double to_rad,
                                   int periods = 0) {
  return {out,
          {.row = 1,
           .first = first,
           .periods = periods,
           .retargets = true,
           .from = out.At(first, kPeriod_s),
           .to_rad = {to_rad, 0.0},
           .profile = MoveProfile::kSeptic}};
}

std::optional<int> Shortest(const std::vector<PlannedMove>& moves, const Design& design,
                            const MotionLimits& limits) {
  return ShortestPeriods(moves, design, kPeriod_s, limits, 1.0);
}

// For the reference model, and for laws that follow a path.
class ShortestFromRest : public testing::TestWithParam<bool> {
 protected:
  std::optional<int> Of(const PlannedMove& move, const MotionLimits& limits) const {
    return Shortest({move}, GetParam() ? ShippedPathDesign() : ShippedDesign(), limits);
  }
};

INSTANTIATE_TEST_SUITE_P(Laws, ShortestFromRest, testing::Bool(),
                         [](const auto& path) { return path.param ? "Path" : "ReferenceModel"; });

TEST_P(ShortestFromRest, IsNeverLessThanTenPeriods) {
  EXPECT_EQ(Of(FromRest(0.0, 0.01), NoLimits()), kFewestPeriods);
}

// The largest rate of a septic move of T is 35/16 of the angle over T; so slow an arm is rigid.
TEST_P(ShortestFromRest, IsSearchedForUpToAMinute) {
  MotionLimits limits = NoLimits();
  const double rate_rad_s = 35.0 / 16.0 * 0.8 / 45.0;
  limits.hub_rate_rad_s[0] = rate_rad_s;
  EXPECT_NEAR(kPeriod_s * Of(FromRest(0.0, 0.8), limits).value(), 45.0, 0.1);
  limits.hub_rate_rad_s[0] = 0.5 * rate_rad_s;
  EXPECT_FALSE(Of(FromRest(0.0, 0.8), limits));
}

TEST_P(ShortestFromRest, IsTheSameWheneverTheMoveBegins) {
  MotionLimits limits = NoLimits();
  limits.hub_rate_rad_s[0] = 1.0;
  const std::optional<int> at_once = Of(FromRest(0.0, 0.8), limits);
  EXPECT_GT(at_once.value(), 60);
  EXPECT_EQ(Of(FromRest(0.0, 0.8, 0, 3000), limits), at_once);
}

TEST_P(ShortestFromRest, KeepsTheSoftLimitsFromWhereItBegins) {
  MotionLimits limits = NoLimits();
  limits.soft_angle_rad[0] = 1.3;
  EXPECT_TRUE(Of(FromRest(0.5, 1.2), limits));
  EXPECT_FALSE(Of(FromRest(0.5, 1.4), limits));
}

TEST(ShortestRetarget, IsNeverLessThanTenPeriods) {
  EXPECT_EQ(Shortest(TakenOver(FromRest(0.0, 0.8, 100), 50, 0.7), ShippedPathDesign(), NoLimits()),
            kFewestPeriods);
}

// The torque continues from that of the move before: no jump from zero.
TEST(ShortestRetarget, DoesNotBeginWithAJumpOfTheTorque) {
  const std::vector<PlannedMove> moves = TakenOver(FromRest(0.0, 0.8, 100), 30, 0.7, 100);
  const RigidPath path(moves, {0.0, 0.0}, 200, kPeriod_s);
  const auto sample =
      QuasiStaticReference(path, MakeRigidJointArm(ShippedPathDesign()), 1.0, kPeriod_s, 30, 30);
  MotionLimits limits = NoLimits();
  limits.slew_nm_per_s[0] = 0.5 * std::fabs(sample[0].u_m_nm[0]) / (4.0 * kPeriod_s);
  EXPECT_TRUE(Shortest(moves, ShippedPathDesign(), limits));
}

// The shorter, the more torque; the longer, the farther the arm goes before it turns round. The
// limits leave 90 to 95 periods, which bisection would not find.
TEST(ShortestRetarget, IsFoundWhereOnlyFewDurationsKeepTheLimits) {
  const PlannedMove out = FromRest(0.0, 1.4, 120);
  const auto of = [&out](int periods) {
    const RigidPath path(TakenOver(out, 50, 0.4, periods), {0.0, 0.0}, 300, kPeriod_s);
    const auto heavy =
        QuasiStaticReference(path, MakeRigidJointArm(ShippedPathDesign()), 1.0, kPeriod_s, 0, 300);
    std::array<double, 2> largest{};  // torque with friction, and angle of either arm
    for (int k = 50; k <= 300; ++k) {
      const ReferenceSample& sample = heavy[static_cast<std::size_t>(k)];
      largest[0] = std::max(largest[0], std::fabs(sample.u_m_nm[0]));
      largest[1] = std::max({largest[1], std::fabs(sample.x_m[0]), path.At(k).angle_rad[0]});
    }
    largest[0] += ShippedLimits().coulomb_friction_nm[0];
    return largest;
  };
  MotionLimits limits = NoLimits();
  limits.torque_nm[0] = of(90)[0] + 1e-9;
  limits.soft_angle_rad[0] = of(95)[1] + 1e-9;
  ASSERT_GT(of(89)[0], limits.torque_nm[0]);
  ASSERT_GT(of(96)[1], limits.soft_angle_rad[0]);
  EXPECT_EQ(Shortest(TakenOver(out, 50, 0.4), ShippedPathDesign(), limits), 90);
}

// Slowly out, and as slowly back, at 0.1 rad/s: some 26 s.
TEST(ShortestRetarget, IsSearchedForUpToAMinuteToo) {
  MotionLimits limits = NoLimits();
  limits.hub_rate_rad_s[0] = 0.1;
  const std::optional<int> periods =
      Shortest(TakenOver(FromRest(0.0, 0.8, 1000), 500, -0.6), ShippedPathDesign(), limits);
  ASSERT_TRUE(periods);
  EXPECT_GT(kPeriod_s * *periods, 20.0);
}

}  // namespace
}  // namespace flexarm
