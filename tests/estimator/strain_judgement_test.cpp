// One bad channel among ten: detected, named and excluded in the first sample that shows it; the
// fit of the others is the fit without that channel.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "estimator/strain_fit.h"
#include "model/arm/arm_model.h"
#include "tests/estimator/thesis_estimator.h"

namespace flexarm {
namespace {

const std::array<double, 4> kBent = {0.03, 1e-4, -0.02, 5e-4};

constexpr double kStrainPerCount = 20.0 / 4096.0 / 5000.0;

// A count is 0.98 microstrain. Rounding of half a count on every channel changes a coordinate by
// 5e-5 m (measured, f21 without its root channel); a bad channel that stays in the fit, by 1e-3 m
// and more.
constexpr double kCoarseRounding_m = 1e-4;

class StrainJudgement : public testing::Test {
 protected:
  SensorFrame FrameOf(const std::array<double, 4>& modal) const {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(arm_.dof());
    q.tail(4) << modal[0], modal[1], modal[2], modal[3];
    SensorFrame frame{};
    for (std::size_t i = 0; i < sensors_.strain.size(); ++i) {
      const StrainChannelConfig& row = sensors_.strain[i];
      const double counts = arm_.Strain(row.link, row.position_m, q) / kStrainPerCount;
      frame.strain[i] = static_cast<std::int32_t>(std::lround(counts));
      frame.strain_valid |= 1u << i;
    }
    return frame;
  }

  static void ExpectBend(const FittedModes& out, const std::array<double, 4>& modal,
                         std::size_t channel) {
    EXPECT_TRUE(out.valid[0] && out.valid[1]);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(out.modal_m[i], modal[i], kCoarseRounding_m)
          << "f" << i << ", bad channel " << channel;
    }
  }

  const SensorConfig sensors_ = ThesisSensors();
  const ArmModel arm_{ThesisRig(), ModeCount{.link1 = 2, .link2 = 2}};
};

TEST_F(StrainJudgement, ASaturatedChannelIsExcludedInTheSameSample) {
  for (std::size_t i = 0; i < 20; ++i) {
    for (const std::int32_t rail : {-2048, 2047}) {
      StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
      SensorFrame frame = FrameOf(kBent);
      frame.strain[i] = rail;
      const FittedModes out = fit.Fit(frame);
      EXPECT_EQ(out.saturated, 1u << i);
      EXPECT_EQ(out.outlier, 0u);
      EXPECT_EQ(out.used, 0xFFFFFu & ~(1u << i));
      ExpectBend(out, kBent, i);
    }
  }
}

// Bent beyond what its gauges can read, a link has too few for a fit; those that are left still
// say that the others are right. Link 1: channels 0 to 9 from the root on.
TEST_F(StrainJudgement, ALinkThatIsBentBeyondTheRangeOfItsGaugesIsSaidToBe) {
  for (const double sign : {1.0, -1.0}) {
    StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
    const std::array<double, 4> far = {sign * 0.32, 0.0, -0.02, 5e-4};
    SensorFrame frame = FrameOf(far);
    ASSERT_GT(std::abs(frame.strain[3]), 2048) << "four gauges are beyond";
    ASSERT_LT(std::abs(frame.strain[4]), 2048);
    for (std::int32_t& counts : frame.strain) counts = std::clamp(counts, -2048, 2047);
    const FittedModes out = fit.Fit(frame);
    EXPECT_FALSE(out.valid[0]);
    EXPECT_NEAR(out.beyond_range[0], 2047.5 * kStrainPerCount, kStrainPerCount);
    EXPECT_EQ(out.beyond_range[1], 0.0) << "it has a fit";
  }
}

TEST_F(StrainJudgement, GaugesThatAreOpenDoNotBendALink) {
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  for (const double tip_m : {0.03, -0.03, 0.0}) {
    SensorFrame frame = FrameOf({tip_m, 0.0, 0.0, 0.0});
    std::fill_n(frame.strain.begin(), 4, 2047);  // far from what the others say
    const FittedModes out = fit.Fit(frame);
    ASSERT_FALSE(out.valid[0]);
    EXPECT_EQ(out.beyond_range[0], 0.0) << tip_m;
  }
  SensorFrame frame = FrameOf({-0.32, 0.0, 0.0, 0.0});
  for (std::int32_t& counts : frame.strain) counts = std::clamp(counts, -2048, 2047);
  std::fill_n(frame.strain.begin(), 4, 2047);
  EXPECT_EQ(fit.Fit(frame).beyond_range[0], 0.0) << "the others are bent the other way";
}

// 1000 microstrain from the fit, the limit being 400; every channel, both signs.
TEST_F(StrainJudgement, AnOutlierChannelIsExcludedInTheSameSample) {
  for (std::size_t i = 0; i < 20; ++i) {
    for (const int sign : {-1, 1}) {
      StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
      SensorFrame frame = FrameOf(kBent);
      frame.strain[i] += sign * 1024;  // 1000 microstrain
      const FittedModes out = fit.Fit(frame);
      EXPECT_EQ(out.outlier, 1u << i);
      EXPECT_EQ(out.used, 0xFFFFFu & ~(1u << i));
      EXPECT_GT(out.worst_outlier, 4e-4);
      ExpectBend(out, kBent, i);
    }
  }
}

// The fit follows the channel next to the root: with an error e it is e (1 - h) from the fit, less
// than the limit of 400 microstrain, and e sqrt(1 - h) studentised, more than that. So the squares
// of the second over e is the first, whatever the leverage h is.
TEST_F(StrainJudgement, AnOutlierThatTheFitFollowsIsSeenToo) {
  constexpr double kMicrostrainPerCount = 0.9766;  // 20 V / 4096 / 5000 V
  const std::array<std::int32_t, 2> error_of_link = {580, 655};
  for (const std::size_t root : {0U, 10U}) {
    const std::int32_t error_counts = error_of_link[root / 10];
    StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
    SensorFrame frame = FrameOf(kBent);
    frame.strain[root] += error_counts;
    const FittedModes out = fit.Fit(frame);
    EXPECT_EQ(out.outlier, 1U << root) << root;
    EXPECT_GT(out.worst_outlier, 4e-4);
    const double error = 1e-6 * kMicrostrainPerCount * error_counts;
    EXPECT_LT(out.worst_outlier * out.worst_outlier / error, 4e-4) << "not seen by the distance";
    ExpectBend(out, kBent, root);
  }
}

// What shows is the studentised distance over the error: of a straight arm, one channel in error.
TEST_F(StrainJudgement, WhatShowsOfAnErrorIsItsStudentisedDistance) {
  constexpr std::int32_t kError_counts = 1024;
  for (std::size_t i = 0; i < 20; ++i) {
    StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
    SensorFrame frame = FrameOf({});
    frame.strain[i] = kError_counts;
    const double distance = fit.Fit(frame).worst_outlier;
    EXPECT_NEAR(fit.ShownOfError(i), distance / (kError_counts * kStrainPerCount), 1e-12) << i;
    EXPECT_LT(fit.ShownOfError(i), 1.0);
  }
}

// Bent by the error of one channel, the polynomial may be farther from another.
TEST_F(StrainJudgement, WhatShowsToThePolynomialIsAtMostTheWorstDistance) {
  EstimatorConfig config = ThesisEstimator();
  config.kind = EstimatorKind::kPolynomial;
  constexpr std::int32_t kError_counts = 1024;
  for (std::size_t i = 0; i < 20; ++i) {
    StrainFit fit(ThesisRig(), sensors_, config);
    SensorFrame frame = FrameOf({});
    frame.strain[i] = kError_counts;
    const double distance = fit.Fit(frame).worst_outlier;
    EXPECT_LE(fit.ShownOfError(i), distance / (kError_counts * kStrainPerCount) + 1e-12) << i;
    EXPECT_GT(fit.ShownOfError(i), 0.1);
  }
}

TEST_F(StrainJudgement, NothingShowsOfAChannelWithoutWhichTheModesAreUnknown) {
  SensorConfig two = sensors_;
  std::erase_if(two.strain, [this](const StrainChannelConfig& row) {
    return row.link == 2 && row.position_m != sensors_.strain[10].position_m &&
           row.position_m != sensors_.strain[15].position_m;
  });
  const StrainFit fit(ThesisRig(), two, ThesisEstimator());
  EXPECT_GT(fit.ShownOfError(9), 0.5) << "link 1 has its ten";
  EXPECT_EQ(fit.ShownOfError(10), 0.0);
  EXPECT_EQ(fit.ShownOfError(11), 0.0);
}

// At most two outliers per link are removed.
TEST_F(StrainJudgement, TwoOutlierChannelsOfALinkAreExcluded) {
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  SensorFrame frame = FrameOf(kBent);
  frame.strain[5] += 1500;
  frame.strain[8] -= 1500;
  const FittedModes out = fit.Fit(frame);
  EXPECT_EQ(out.outlier, 1u << 5 | 1u << 8);
  ExpectBend(out, kBent, 5);
}

// A channel that is constant while its link bends: stuck once the fit at its station has changed by
// the limit of 100 microstrain, long before it is an outlier.
TEST_F(StrainJudgement, AStuckChannelIsExcludedInTheSampleThatShowsIt) {
  for (std::size_t i = 0; i < 20; ++i) {
    StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
    const SensorFrame rest = FrameOf({});
    fit.Fit(rest);
    bool found = false;
    for (int k = 1; k <= 200 && !found; ++k) {
      const double share = 0.01 * k;
      // Bent until the strain at the stations near the tips has changed too.
      const std::array<double, 4> bend = {share * 0.03, 0.0, share * -0.03, 0.0};
      SensorFrame frame = FrameOf(bend);
      frame.strain[i] = rest.strain[i];
      const bool others_saturated = std::abs(frame.strain[0]) >= 2047;
      ASSERT_FALSE(others_saturated) << "channel " << i << " never changed enough";
      const FittedModes out = fit.Fit(frame);
      if (out.stuck == 0) continue;
      found = true;
      EXPECT_EQ(out.stuck, 1u << i);
      EXPECT_EQ(out.outlier, 0u) << "stuck is detected first";
      EXPECT_EQ(out.used & (1u << i), 0u) << "channel " << i;
      ExpectBend(out, bend, i);
    }
    // At the free ends there is hardly any strain. The limit is 102 counts; the fit to the other
    // channels errs by their quantisation, a count at the station.
    const double moves = FrameOf({0.06, 0.0, -0.06, 0.0}).strain[i] - rest.strain[i];
    EXPECT_TRUE(found || std::abs(moves) < 104) << i;
    EXPECT_TRUE(!found || std::abs(moves) > 100) << i;
  }
}

TEST_F(StrainJudgement, ChannelsOfAnArmAtRestAreNotStuck) {
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  for (int k = 0; k < 500; ++k) EXPECT_EQ(fit.Fit(FrameOf(kBent)).stuck, 0u);
}

// A link that bends in more than its fitted modes, in a steady part of a move: the two channels at
// the root repeat their values once, by chance, and the others alone expect another strain there.
TEST_F(StrainJudgement, ChannelsThatRepeatByChanceAreNotStuck) {
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  SensorFrame frame = FrameOf(kBent);
  for (const std::size_t i : {0U, 1U}) frame.strain[i] += 250;
  for (const std::size_t i : {3U, 4U, 5U}) frame.strain[i] -= 150;
  EXPECT_EQ(fit.Fit(frame).outlier, 0U);
  for (std::size_t i = 2; i < 10; ++i) frame.strain[i] += i % 2 == 0 ? 1 : -1;
  EXPECT_EQ(fit.Fit(frame).stuck, 0U);
}

// Symptom: with a frame lost while the arm swung back, the channels that then read 0, as the empty
// frame had, were stuck; too few were left for the fit, and the second sample without one tripped.
TEST_F(StrainJudgement, WhatAMissingReadingLeavesBehindIsNotRepeated) {
  const SensorFrame straight = FrameOf({});
  for (std::size_t i = 0; i < 20; ++i) ASSERT_EQ(straight.strain[i], 0);
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  fit.Fit(FrameOf(kBent));
  EXPECT_FALSE(fit.Fit(SensorFrame{}).valid[0]);
  const FittedModes out = fit.Fit(straight);
  EXPECT_EQ(out.stuck, 0U);
  EXPECT_EQ(out.repeated, (std::array<std::uint32_t, 2>{0, 0}));
  EXPECT_EQ(out.gauges, (std::array{10, 10}));
  ExpectBend(out, {}, 20);
}

TEST_F(StrainJudgement, AStuckChannelIsSeenAcrossAMissingReading) {
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  fit.Fit(FrameOf({}));
  SensorFrame missing = FrameOf({0.02, 0.0, -0.02, 0.0});
  missing.strain_valid &= ~1U;
  missing.strain[0] = 7;
  EXPECT_EQ(fit.Fit(missing).stuck, 0U);
  SensorFrame frame = FrameOf(kBent);
  frame.strain[0] = 0;
  EXPECT_EQ(fit.Fit(frame).stuck, 1U);
}

TEST_F(StrainJudgement, ALinkWhoseGoodChannelsAllRepeatIsTold) {
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  SensorFrame frame = FrameOf(kBent);
  EXPECT_EQ(fit.Fit(frame).repeated, (std::array<std::uint32_t, 2>{0, 0})) << "the first frame";
  EXPECT_EQ(fit.Fit(frame).repeated, (std::array<std::uint32_t, 2>{0x3FF, 0xFFC00}));
  ++frame.strain[4];
  EXPECT_EQ(fit.Fit(frame).repeated, (std::array<std::uint32_t, 2>{0, 0xFFC00}));
  frame.strain_valid &= ~(1U << 12);
  EXPECT_EQ(fit.Fit(frame).repeated, (std::array<std::uint32_t, 2>{0x3FF, 0xFEC00}));
  frame.strain_valid = 0x3FF;
  EXPECT_EQ(fit.Fit(frame).repeated, (std::array<std::uint32_t, 2>{0x3FF, 0})) << "no good channel";
}

TEST_F(StrainJudgement, ResetClearsTheStuckDetection) {
  StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
  fit.Fit(FrameOf({}));
  SensorFrame frame = FrameOf(kBent);
  frame.strain[0] = 0;
  EXPECT_NE(fit.Fit(frame).stuck, 0u);
  fit.Reset({});
  EXPECT_EQ(fit.Fit(frame).stuck, 0u);
}

}  // namespace
}  // namespace flexarm
