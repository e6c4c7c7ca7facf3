// Limits of a path for any payload, compared with the two arms sample by sample.

#include "controller/reference/path_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/reference/no_limits.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr double kShare = 0.8;
constexpr int kPeriods = 160;

// A move, and a new target during it: the hubs of a heavy arm lead during acceleration, and stay
// behind where it turns round.
RigidPath OutAndBack() {
  const PlannedMove out{.row = 0,
                        .first = 10,
                        .periods = 100,
                        .retargets = false,
                        .from = {},
                        .to_rad = {0.8, -0.5},
                        .profile = MoveProfile::kSeptic};
  const PlannedMove back{.row = 1,
                         .first = 60,
                         .periods = 90,
                         .retargets = true,
                         .from = out.At(60, kPeriod_s),
                         .to_rad = {0.1, 0.3},
                         .profile = MoveProfile::kSeptic};
  return {std::array{out, back}, {0.0, 0.0}, kPeriods, kPeriod_s};
}

// What a limit of PathCheck is compared with: index 0 or 1 is the joint.
struct Compared {
  std::array<double, 2> MotionLimits::* limit;
  double share;               // of it
  std::vector<double> heavy;  // by sample, with 1 kg
  std::vector<double> rigid;  // without payload: no lead
};

Compared Angles(const RigidPath& path, const std::vector<ReferenceSample>& heavy, std::size_t i) {
  Compared out{.limit = &MotionLimits::soft_angle_rad, .share = 1.0, .heavy = {}, .rigid = {}};
  for (int k = 0; k <= kPeriods; ++k) {
    out.heavy.push_back(std::fabs(heavy[static_cast<std::size_t>(k)].x_m[i]));
    out.rigid.push_back(std::fabs(path.At(k).angle_rad[i]));
  }
  return out;
}

Compared Rates(const RigidPath& path, const std::vector<ReferenceSample>& heavy, std::size_t i) {
  Compared out{.limit = &MotionLimits::hub_rate_rad_s, .share = kShare, .heavy = {}, .rigid = {}};
  for (int k = 0; k <= kPeriods; ++k) {
    out.heavy.push_back(std::fabs(heavy[static_cast<std::size_t>(k)].x_m[6 + i]));
    out.rigid.push_back(std::fabs(path.At(k).rate_rad_s[i]));
  }
  return out;
}

// First sample from `first` to `last` above a limit; none: one beyond all.
int FirstAbove(const std::vector<double>& value, double limit, int first, int last) {
  for (int k = first; k <= last; ++k) {
    if (value[static_cast<std::size_t>(k)] > limit) return k;
  }
  return std::numeric_limits<int>::max();
}

TEST(PathCheck, FindsTheFirstSampleAtWhichEitherArmBreaksALimitAndNamesIt) {
  const RigidPath path = OutAndBack();
  const auto heavy = QuasiStaticReference(path, MakeRigidJointArm(ShippedPathDesign()), 1.0,
                                          kPeriod_s, 0, kPeriods);
  int by_heavy = 0, by_rigid = 0, by_none = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    for (const Compared& c : {Angles(path, heavy, i), Rates(path, heavy, i)}) {
      const double largest = *std::max_element(c.heavy.begin(), c.heavy.end());
      for (int percent = 3; percent <= 103; percent += 5) {
        MotionLimits limits = NoLimits();
        const double limit = 0.01 * percent * largest;
        (limits.*c.limit)[i] = limit / c.share;
        const PathCheck check(ShippedPathDesign(), limits, LimitShares::Of(kShare), kPeriod_s);
        for (const auto& [first, last] :
             {std::array{0, kPeriods}, {30, 50}, {60, 90}, {70, 70}, {100, 140}}) {
          SCOPED_TRACE(testing::Message() << "joint " << i + 1 << ", " << percent << " %, samples "
                                          << first << " to " << last);
          const int h = FirstAbove(c.heavy, limit, first, last);
          const int r = FirstAbove(c.rigid, limit, first, last);
          const auto broken = check.First(path, first, last);
          if (std::min(h, r) == std::numeric_limits<int>::max()) {
            EXPECT_FALSE(broken);
            ++by_none;
            continue;
          }
          ASSERT_TRUE(broken);
          EXPECT_EQ(broken->sample, std::min(h, r));
          const bool with_payload =
              broken->text.find("(with 1 kg, controller.payload.max_kg)") != std::string::npos;
          EXPECT_EQ(with_payload, h <= r) << broken->text;
          ++(h <= r ? by_heavy : by_rigid);
        }
      }
    }
  }
  EXPECT_GT(std::min({by_heavy, by_rigid, by_none}), 20) << "the paths are inconclusive";
}

// In mid-path the first change of torque is relative to the sample before, not to zero: the changes
// are those of a smooth path, a tenth of the torque.
TEST(PathCheck, APathCheckedFromItsMiddleDoesNotBeginWithAJump) {
  const RigidPath path = OutAndBack();
  const auto heavy = QuasiStaticReference(path, MakeRigidJointArm(ShippedPathDesign()), 1.0,
                                          kPeriod_s, 0, kPeriods);
  double largest_nm = 0.0;
  for (std::size_t k = 31; k <= 50; ++k) {
    largest_nm = std::max(largest_nm, std::fabs(heavy[k].u_m_nm[0] - heavy[k - 1].u_m_nm[0]));
  }
  ASSERT_GT(std::fabs(heavy[31].u_m_nm[0]), 2.0 * largest_nm) << "the path is inconclusive";
  const auto broken = [&](double slew_nm) {
    MotionLimits limits = NoLimits();
    limits.slew_nm_per_s[0] = slew_nm / (4.0 * kPeriod_s * kShare);  // over four periods
    return PathCheck(ShippedPathDesign(), limits, LimitShares::Of(kShare), kPeriod_s)
        .First(path, 31, 50);
  };
  EXPECT_FALSE(broken(1.01 * largest_nm));
  EXPECT_TRUE(broken(0.99 * largest_nm));
}

}  // namespace
}  // namespace flexarm
