// The septic polynomial that retargets a moving arm, by its conditions at both ends.

#include "controller/reference/retarget.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <random>
#include <vector>

#include "controller/types/motion_profile.h"

namespace flexarm {
namespace {

struct Case {
  RigidPoint from;
  std::array<double, 2> to_rad;
  double duration_s;
};

// States with the rates and jerks of moves of about a second.
std::vector<Case> Cases() {
  std::mt19937 random(7);
  const auto pair = [&random](double largest) {
    std::uniform_real_distribution<double> uniform(-largest, largest);
    return std::array<double, 2>{uniform(random), uniform(random)};
  };
  std::vector<Case> cases(50);
  for (Case& c : cases) {
    c.from = {.angle_rad = pair(1.5),
              .rate_rad_s = pair(4.0),
              .acceleration_rad_s2 = pair(10.0),
              .jerk_rad_s3 = pair(50.0)};
    c.to_rad = pair(1.5);
    c.duration_s = 1.2 + pair(1.0)[0];
  }
  return cases;
}

// Round-off: coefficients up to 20 x 10 rad, of which the k-th derivative is divided by T^k.
TEST(SepticToRest, BeginsWithTheStateOfTheArmAndEndsAtRest) {
  for (const Case& c : Cases()) {
    const double T = c.duration_s;
    const RigidPoint start = SepticToRest(c.from, c.to_rad, T, 0.0),
                     end = SepticToRest(c.from, c.to_rad, T, T);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(start.angle_rad[i], c.from.angle_rad[i], 1e-13);
      EXPECT_NEAR(start.rate_rad_s[i], c.from.rate_rad_s[i], 1e-12 / T);
      EXPECT_NEAR(start.acceleration_rad_s2[i], c.from.acceleration_rad_s2[i], 1e-11 / (T * T));
      EXPECT_NEAR(start.jerk_rad_s3[i], c.from.jerk_rad_s3[i], 1e-10 / (T * T * T));
      EXPECT_EQ(end.angle_rad[i], c.to_rad[i]);
      EXPECT_EQ(end.rate_rad_s[i], 0.0);
      EXPECT_EQ(end.acceleration_rad_s2[i], 0.0);
      EXPECT_EQ(end.jerk_rad_s3[i], 0.0);
    }
    EXPECT_EQ(SepticToRest(c.from, c.to_rad, T, T + 1.0).angle_rad, end.angle_rad);
    EXPECT_EQ(SepticToRest(c.from, c.to_rad, T, -1.0).jerk_rad_s3, start.jerk_rad_s3);
  }
}

// The eighth difference of a polynomial of degree seven is 0; of x^8 over steps of T / 8 it is
// 8! / 8^8 = 2.4e-3 times its coefficient. Round-off: 256 times that of values up to 30 rad.
TEST(SepticToRest, IsOfDegreeSeven) {
  constexpr std::array<double, 9> kBinomial = {1, -8, 28, -56, 70, -56, 28, -8, 1};
  for (const Case& c : Cases()) {
    for (std::size_t i = 0; i < 2; ++i) {
      double difference = 0.0;
      for (std::size_t k = 0; k < kBinomial.size(); ++k) {
        const double t = c.duration_s * static_cast<double>(k) / 8.0;
        difference += kBinomial[k] * SepticToRest(c.from, c.to_rad, c.duration_s, t).angle_rad[i];
      }
      EXPECT_NEAR(difference, 0.0, 1e-11);
    }
  }
}

// Central differences over 2e-5 T err by (2e-5)^2 / 6 times the third derivative of what they
// differentiate, up to 1e6 over T^n, and by round-off of 1e-14 / 4e-5.
TEST(SepticToRest, ItsDerivativesAreThoseOfItsAngles) {
  for (const Case& c : Cases()) {
    const double T = c.duration_s, h = 2e-5 * T;
    for (double t = 0.05 * T; t < T; t += 0.1 * T) {
      const auto at = [&](double time_s) { return SepticToRest(c.from, c.to_rad, T, time_s); };
      const RigidPoint before = at(t - h), now = at(t), after = at(t + h);
      for (std::size_t i = 0; i < 2; ++i) {
        const auto rate = [&](const std::array<double, 2>& a, const std::array<double, 2>& b) {
          return (b[i] - a[i]) / (2.0 * h);
        };
        EXPECT_NEAR(now.rate_rad_s[i], rate(before.angle_rad, after.angle_rad), 1e-6 / T);
        EXPECT_NEAR(now.acceleration_rad_s2[i], rate(before.rate_rad_s, after.rate_rad_s),
                    1e-5 / (T * T));
        EXPECT_NEAR(now.jerk_rad_s3[i], rate(before.acceleration_rad_s2, after.acceleration_rad_s2),
                    1e-4 / (T * T * T));
      }
    }
  }
}

TEST(SepticToRest, FromRestItIsTheSepticProfile) {
  const RigidPoint rest{
      .angle_rad = {0.3, -0.4}, .rate_rad_s = {}, .acceleration_rad_s2 = {}, .jerk_rad_s3 = {}};
  const std::array<double, 2> to_rad = {-0.9, 1.1};
  constexpr double T = 1.3;
  for (double x = 0.0; x <= 1.0; x += 0.0625) {
    const RigidPoint point = SepticToRest(rest, to_rad, T, x * T);
    const ProfilePoint profile = ProfileAt(MoveProfile::kSeptic, x);
    for (std::size_t i = 0; i < 2; ++i) {
      const double by_rad = to_rad[i] - rest.angle_rad[i];
      EXPECT_NEAR(point.angle_rad[i], rest.angle_rad[i] + by_rad * profile.s, 1e-14);
      EXPECT_NEAR(point.rate_rad_s[i], by_rad * profile.ds / T, 1e-13);
      EXPECT_NEAR(point.acceleration_rad_s2[i], by_rad * profile.dds / (T * T), 1e-12);
      EXPECT_NEAR(point.jerk_rad_s3[i], by_rad * profile.ddds / (T * T * T), 1e-11);
    }
  }
}

}  // namespace
}  // namespace flexarm
