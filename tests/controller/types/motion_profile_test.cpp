// Profiles against finite differences and the closed forms of their peaks.

#include "controller/types/motion_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr MoveProfile kProfiles[] = {MoveProfile::kQuintic, MoveProfile::kSeptic};

// Central differences over h = 1e-5 err by h^2/6 times a fifth derivative up to 1e4, 2e-7, and by
// round-off of 1e-16 / h.
TEST(MotionProfile, DerivativesAreThoseOfThePolynomial) {
  constexpr double h = 1e-5;
  for (const MoveProfile profile : kProfiles) {
    for (double x = 0.05; x < 1.0; x += 0.05) {
      const ProfilePoint before = ProfileAt(profile, x - h), after = ProfileAt(profile, x + h);
      const ProfilePoint now = ProfileAt(profile, x);
      EXPECT_NEAR(now.ds, (after.s - before.s) / (2.0 * h), 1e-6);
      EXPECT_NEAR(now.dds, (after.ds - before.ds) / (2.0 * h), 1e-6);
      EXPECT_NEAR(now.ddds, (after.dds - before.dds) / (2.0 * h), 1e-6);
    }
  }
}

TEST(MotionProfile, StartsAndEndsAtRest) {
  for (const MoveProfile profile : kProfiles) {
    const ProfilePoint start = ProfileAt(profile, 0.0), end = ProfileAt(profile, 1.0);
    EXPECT_EQ(start.s, 0.0);
    EXPECT_EQ(end.s, 1.0);
    for (const ProfilePoint& point : {start, end}) {
      EXPECT_NEAR(point.ds, 0.0, 1e-12);
      EXPECT_NEAR(point.dds, 0.0, 1e-12);
    }
    for (const double x : {-0.5, 1.5}) {
      const ProfilePoint beyond = ProfileAt(profile, x);
      EXPECT_EQ(beyond.s, x < 0.0 ? 0.0 : 1.0);
      EXPECT_EQ(beyond.ddds, 0.0);
    }
  }
  EXPECT_NEAR(ProfileAt(MoveProfile::kSeptic, 1.0).ddds, 0.0, 1e-12);
}

// Peaks: the derivative of s'' is 0 at x = 1/2 -+ 1/sqrt(12) (quintic), -+ 1/sqrt(20) (septic);
// the design study rounds them to 5.77 and 1.875, 7.51 and 2.19. A grid of 1e-4 misses the peak by
// 1e-6.
TEST(MotionProfile, PeaksAreThoseOfTheClosedForm) {
  const auto peaks = [](MoveProfile profile) {
    std::pair<double, double> peak{};
    for (int i = 0; i <= 10000; ++i) {
      const ProfilePoint point = ProfileAt(profile, i * 1e-4);
      peak.first = std::max(peak.first, std::fabs(point.ds));
      peak.second = std::max(peak.second, std::fabs(point.dds));
    }
    return peak;
  };
  const auto quintic = peaks(MoveProfile::kQuintic), septic = peaks(MoveProfile::kSeptic);
  EXPECT_NEAR(quintic.first, 15.0 / 8.0, 1e-6);
  EXPECT_NEAR(quintic.second, 10.0 / std::sqrt(3.0), 1e-5);
  EXPECT_NEAR(septic.first, 35.0 / 16.0, 1e-6);
  EXPECT_NEAR(septic.second, 84.0 / (5.0 * std::sqrt(5.0)), 1e-5);
  EXPECT_NEAR(septic.second, 7.51, 5e-3);
  EXPECT_NEAR(septic.first, 2.19, 5e-3);
}

// The closed forms hold for n periods as the profile takes T = (n - 1) Ts. A second difference errs
// by s''''/12 (n - 1)^2, and the samples miss the peak by at most half a period, s''''/8 (n - 1)^2:
// with |s''''| = 375 at the peak of the septic 0.21 x 375 = 78; less for the quintic and the rate.
TEST(MotionProfile, HeldAccelerationsPeakAsTheProfileDoes) {
  for (const MoveProfile profile : kProfiles) {
    const bool septic = profile == MoveProfile::kSeptic;
    for (const int n : {25, 50, 100, 1000}) {
      const double T = (n - 1) * kPeriod_s;
      double rate = 0.0, peak_rate = 0.0, peak = 0.0;
      for (const double value : ProfileAccelerations(profile, n, kPeriod_s)) {
        rate += value * kPeriod_s;
        peak_rate = std::max(peak_rate, std::fabs(rate));
        peak = std::max(peak, std::fabs(value));
      }
      const double tolerance = 78.0 / ((n - 1) * (n - 1));
      EXPECT_NEAR(peak_rate * T, septic ? 35.0 / 16.0 : 15.0 / 8.0, tolerance) << n;
      EXPECT_NEAR(peak * T * T, septic ? 84.0 / (5.0 * std::sqrt(5.0)) : 10.0 / std::sqrt(3.0),
                  tolerance)
          << n;
    }
  }
}

// Second differences of numbers up to 1 carry 1e-16 / Ts^2 of round-off each, which the double
// integral turns into 1e-16 n^2 / 2: 1e-12 for 100 periods.
TEST(MotionProfile, ADoubleIntegratorIsAtRestAtOneWhenItEnds) {
  for (const MoveProfile profile : kProfiles) {
    for (const int n : {10, 11, 50, 99}) {
      double angle = 0.0, rate = 0.0;
      for (const double value : ProfileAccelerations(profile, n, kPeriod_s)) {
        angle += kPeriod_s * rate + 0.5 * kPeriod_s * kPeriod_s * value;
        rate += kPeriod_s * value;
      }
      EXPECT_NEAR(angle, 1.0, 1e-12) << n;
      EXPECT_NEAR(rate, 0.0, 1e-12) << n;
    }
  }
}

}  // namespace
}  // namespace flexarm
