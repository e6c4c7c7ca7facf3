// The fit of a link without some of its gauges: which sets it accepts, and what they are worth.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "estimator/strain_fit.h"
#include "model/arm/arm_model.h"
#include "model/math/dense_decompositions.h"
#include "tests/estimator/thesis_estimator.h"

namespace flexarm {
namespace {

constexpr int kPerLink = 10;
constexpr double kCount = 20.0 / 4096.0 / 5000.0;  // unit strain of a count of the thesis's rig
const std::array<double, 4> kBent = {0.03, 1e-4, -0.02, 5e-4};

// Ten gauges a link and two modes, of which the strain of a unit coordinate is computed
// independently of the fit.
class MissingGauges : public testing::TestWithParam<int> {  // the link, 0 or 1
 protected:
  MissingGauges() {
    for (int j = 0; j < 2; ++j) {
      Eigen::VectorXd q = Eigen::VectorXd::Zero(arm_.dof());
      q(arm_.dof() - 4 + 2 * link() + j) = 1.0;
      for (int i = 0; i < kPerLink; ++i) shape_(i, j) = StrainAt(i, q);
      root_(j) = arm_.Strain(link() + 1, 0.0, q);
    }
  }

  int link() const { return GetParam(); }
  std::size_t index() const { return static_cast<std::size_t>(GetParam()); }
  double StrainAt(int i, const Eigen::VectorXd& q) const {
    const auto row = static_cast<std::size_t>(kPerLink * link() + i);
    return arm_.Strain(link() + 1, sensors_.strain[row].position_m, q);
  }

  // Standard deviations of f1, f2 and the strain at the root by least squares, for one count of
  // noise on each gauge of `set`; infinite if they are not determined.
  Eigen::Vector3d Spread(unsigned set) const {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    for (int i = 0; i < kPerLink; ++i) {
      if ((set >> i & 1U) != 0) normal += shape_.row(i).transpose() * shape_.row(i);
    }
    if (std::popcount(set) < 2) {
      return Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    }
    const Eigen::Matrix2d covariance = kCount * kCount * normal.inverse();
    const double root = (root_ * covariance * root_.transpose()).value();
    return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(root)};
  }

  SensorFrame Bent(unsigned set) const {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(arm_.dof());
    q.tail(4) << kBent[0], kBent[1], kBent[2], kBent[3];
    SensorFrame frame{};
    for (std::size_t i = 0; i < sensors_.strain.size(); ++i) {
      const StrainChannelConfig& row = sensors_.strain[i];
      frame.strain[i] =
          static_cast<std::int32_t>(std::lround(arm_.Strain(row.link, row.position_m, q) / kCount));
    }
    frame.strain_valid = set << kPerLink * link() | 0x3FFU << kPerLink * (1 - link());
    return frame;
  }

  const SensorConfig sensors_ = ThesisSensors();
  const ArmModel arm_{ThesisRig(), ModeCount{.link1 = 2, .link2 = 2}};
  Eigen::Matrix<double, kPerLink, 2> shape_;
  Eigen::RowVector2d root_;
};

// Every one of the 1024 sets: accepted exactly if three gauges or more are left and each quantity
// has at most twice the standard deviation of all ten. An accepted set recovers the bending
// within half a count of rounding on each gauge, which is at most sqrt(10)/2 of these deviations,
// if they are worst. What is not accepted is unknown.
TEST_P(MissingGauges, ASetIsAcceptedExactlyIfItDeterminesTheModes) {
  const Eigen::Vector3d all = Spread(0x3FF);
  std::array<int, kPerLink + 1> accepted{}, sets{};
  for (unsigned set = 0; set < 1U << kPerLink; ++set) {
    const Eigen::Vector3d spread = Spread(set);
    const double worst = (spread.array() / all.array()).maxCoeff();
    const bool expected = std::popcount(set) >= 3 && worst <= StrainFit::kMostSpread;
    StrainFit fit(ThesisRig(), sensors_, ThesisEstimator());
    const FittedModes out = fit.Fit(Bent(set));
    const auto left = static_cast<std::size_t>(std::popcount(set));
    ++sets[left];
    if (out.valid[index()]) ++accepted[left];
    if (std::fabs(worst / StrainFit::kMostSpread - 1.0) > 1e-9) {
      ASSERT_EQ(out.valid[index()], expected) << set << ": " << worst;
    }
    EXPECT_EQ(out.gauges[index()], std::popcount(set));
    EXPECT_TRUE(out.valid[1 - index()]) << "the other link is not concerned";
    EXPECT_EQ(std::isnan(out.root_strain[index()]), !out.valid[index()]) << set;
    if (!out.valid[index()]) continue;
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t k = 2 * index() + j;
      EXPECT_NEAR(out.modal_m[k], kBent[k],
                  0.5 * std::sqrt(10.0) * spread(static_cast<Eigen::Index>(j)))
          << set;
    }
  }
  std::printf("  link %d, all gauges: f1 %.3g m, f2 %.3g m, root %.3g\n", link() + 1, all(0),
              all(1), all(2));
  for (std::size_t left = 2; left <= kPerLink; ++left) {
    std::printf("  %2zu left: %3d of %3d sets\n", left, accepted[left], sets[left]);
  }
  EXPECT_EQ(accepted[kPerLink - 1], 10) << "any one may be missing";
  EXPECT_EQ(accepted[kPerLink - 2], link() == 0 ? 45 : 44) << "of 45: any two, but for one pair";
  EXPECT_EQ(accepted[2], 0) << "two gauges cannot check each other";
}

// The observers are designed for estimator.modal_sigma_m, whatever gauges are left.
TEST_P(MissingGauges, TheNoiseOfAnAcceptedSetIsBelowThatOfTheObserversDesign) {
  const Eigen::Vector3d all = Spread(0x3FF);
  const EstimatorConfig config = ThesisEstimator();
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_LT(StrainFit::kMostSpread * all(static_cast<Eigen::Index>(j)),
              config.modal_sigma_m[2 * index() + j]);
  }
}

INSTANTIATE_TEST_SUITE_P(Links, MissingGauges, testing::Values(0, 1), [](const auto& shown) {
  return "Link" + std::to_string(shown.param + 1);
});

// One mode and two gauges: either may be missing by its spread, but one gauge checks nothing.
TEST(MissingGaugesOfASmallLink, ALinkNeedsOneGaugeMoreThanModesIfItHasThem) {
  SensorConfig two = ThesisSensors();
  two.strain = {two.strain[0], two.strain[1], two.strain[10]};
  EstimatorConfig config = ThesisEstimator();
  config.modes_per_link = 1;
  StrainFit fit(ThesisRig(), two, config);
  EXPECT_EQ(fit.gauges_needed(), (std::array<int, 2>{2, 1})) << "link 2 has one, and needs it";
  SensorFrame frame{};
  frame.strain_valid = 0b111;
  EXPECT_EQ(fit.Fit(frame).valid, (std::array{true, true}));
  frame.strain_valid = 0b101;
  EXPECT_EQ(fit.Fit(frame).valid, (std::array{false, true}));
  frame.strain_valid = 0b011;
  EXPECT_EQ(fit.Fit(frame).valid, (std::array{true, false}));
}

// A calibration that is not a number makes no bending: the fit is not valid, instead of NaN.
TEST(MissingGaugesOfASmallLink, AReadingThatIsNaNMakesTheBendingUnknown) {
  StrainFit fit(ThesisRig(), ThesisSensors(), ThesisEstimator());
  Calibration calibration{};
  calibration.strain_zero_counts[12] = std::numeric_limits<float>::quiet_NaN();
  fit.Reset(calibration);
  SensorFrame frame{};
  frame.strain_valid = 0xFFFFF;
  const FittedModes out = fit.Fit(frame);
  EXPECT_EQ(out.valid, (std::array{true, false}));
  EXPECT_TRUE(std::isnan(out.root_strain[1]));
  for (const double coordinate : out.modal_m) EXPECT_TRUE(std::isfinite(coordinate));
}

}  // namespace
}  // namespace flexarm
