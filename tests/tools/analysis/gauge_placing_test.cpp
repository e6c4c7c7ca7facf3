// The numbers come from a program in Python written for this test, with its own mode shapes and
// its own least squares.

#include "tools/analysis/gauge_placing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "model/math/dense_decompositions.h"
#include "tests/support/thesis_rig.h"
#include "tools/analysis/gauge_verification.h"

namespace flexarm {
namespace {

RigConfig GaugedRig(const std::string& file = "thesis-rig.toml") {
  return LoadConfig(std::string(FLEXARM_SOURCE_DIR "/config/") + file);
}

GaugeShapes ShapesOf(int link, int count) {
  const ArmParameters arm = ThesisRig();
  return link == 1 ? GaugeShapes(arm.link[0], Link1Modes(arm, count), count)
                   : GaugeShapes(arm.link[1], Link2Modes(arm, count), count);
}

TEST(GaugePlacing, KnowsTheShippedGaugesAndTheHalfBridges) {
  const auto links = CompareGauges(GaugedRig());
  ASSERT_EQ(links.size(), 2U);
  EXPECT_NEAR(links[0].task.noise_strain / 1.01643848e-6, 1.0, 1e-8);
  EXPECT_NEAR(links[0].shipped.sigma_m(0) / 5.28491956e-05, 1.0, 1e-7);
  EXPECT_NEAR(links[0].shipped.sigma_m(1) / 4.27385192e-07, 1.0, 1e-7);
  EXPECT_NEAR(links[0].shipped.tip_sigma_m / 5.28529386e-05, 1.0, 1e-7);
  EXPECT_NEAR(links[0].shipped.next_mode[0], 2.50020597, 1e-6);
  EXPECT_NEAR(links[1].shipped.sigma_m(0) / 9.46667472e-05, 1.0, 1e-7);
  EXPECT_NEAR(links[1].shipped.sigma_m(1) / 5.64682578e-06, 1.0, 1e-7);
  EXPECT_NEAR(links[1].shipped.next_mode[1], 0.08640276, 1e-7);
  // Local maxima of strain: of mode 3 at 0.3905 m, of mode 4 at 0.2456 and 0.5511 m of link 1.
  const auto& maxima = links[1].thesis.position_m;
  ASSERT_EQ(maxima.size(), kThesisHalfBridges);
  const double expected[] = {0.01, 0.2112, 0.302, 0.5343, 0.6894};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(maxima[i], expected[i], 2.3e-3) << i;
}

TEST(GaugePlacing, TheShippedHalfBridgesAreThoseOfTheRule) {
  const auto links = CompareGauges(GaugedRig("half-bridges.toml"));
  const double sigma[][2] = {{6.47876336e-05, 8.18638814e-07}, {1.17844279e-04, 7.04165612e-06}};
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(links[i].shipped.position_m.size(), kThesisHalfBridges);
    for (int j = 0; j < 2; ++j) {
      EXPECT_NEAR(links[i].shipped.sigma_m(j) / sigma[i][j], 1.0, 1e-7);
    }
    for (std::size_t k = 0; k < kThesisHalfBridges; ++k) {
      EXPECT_NEAR(links[i].shipped.position_m[k], links[i].thesis.position_m[k], 1e-3);
    }
  }
}

// All triples on a grid of twice the program's step, by the program in Python.
TEST(GaugePlacing, FindsTheBestOfAllTriples) {
  const auto links = CompareGauges(GaugedRig(), {.modes = 2, .per_link = 3});
  EXPECT_LE(links[0].proposed.covariance_m2.determinant(), 2.7318156815e-21);
  EXPECT_LE(links[1].proposed.covariance_m2.determinant(), 9.8846572299e-19);
  EXPECT_NEAR(links[1].proposed.position_m[1], 0.45, 1e-9);
}

// For one mode the gauges crowd where its strain is largest, which is at the root.
TEST(GaugePlacing, CrowdsAtTheRootForOneMode) {
  const std::vector<double> x = BestGaugePositions(
      ShapesOf(2, 2), {.modes = 1, .count = 4, .noise_strain = 1e-6, .spacing_m = 0.05});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(x[i], 0.01 + 0.05 * static_cast<double>(i), 7e-3);
    EXPECT_GE(x[i] - (i > 0 ? x[i - 1] : -1.0), 0.05 - 1e-9);
  }
}

TEST(GaugePlacing, ErrorsFallWithNoiseAndNumber) {
  const auto coarse = CompareGauges(GaugedRig(), {.modes = 2, .noise_strain = 2e-6});
  const auto fine = CompareGauges(GaugedRig(), {.modes = 2, .noise_strain = 1e-6});
  EXPECT_NEAR(coarse[0].proposed.sigma_m(0) / fine[0].proposed.sigma_m(0), 2.0, 1e-9);
  for (const auto& link : fine) {
    EXPECT_LT(link.proposed.covariance_m2.determinant(), link.shipped.covariance_m2.determinant());
  }
}

TEST(GaugePlacing, RefusesWhatDoesNotDetermineTheModes) {
  const GaugeShapes shapes = ShapesOf(1, 3);
  EXPECT_THROW(BestGaugePositions(shapes, {.modes = 2, .count = 1}), std::invalid_argument);
  EXPECT_THROW(BestGaugePositions(shapes, {.modes = 2, .count = 50}), std::invalid_argument);
  EXPECT_THROW(JudgeGauges(shapes, 2, {0.1, 0.1}, {1e-6, 1e-6}), std::invalid_argument);
  EXPECT_THROW(JudgeGauges(shapes, 2, {0.1}, {1e-6}), std::invalid_argument);
}

// Without noise, converter steps and other modes both fits are exact where they can be; here the
// arm has four modes and a coarse converter. The scatter of the modal fit is the covariance's.
TEST(GaugeVerification, ScattersAsTheCovarianceSays) {
  const RigConfig config = GaugedRig();
  const auto links = CompareGauges(config);
  const GaugeVerification run = VerifyGauges(config, false);
  ASSERT_EQ(run.sample.size(), 150U);  // 3 s at 50 Hz
  for (std::size_t i = 0; i < 2; ++i) {
    // 150 samples: 6 % of scatter; the modes that are not fitted add a few per cent.
    EXPECT_NEAR(run.modal[i].rms_mm / (1e3 * links[i].shipped.tip_sigma_m), 1.0, 0.25);
    EXPECT_LT(run.polynomial[i].rms_mm, 0.05 * run.largest_mm[i]);
    EXPECT_GT(run.polynomial[i].rms_mm, run.modal[i].rms_mm);
  }
  // The filter lags: 8 ms behind a motion of 6.6 Hz.
  EXPECT_GT(VerifyGauges(config, true).modal[1].rms_mm, 3.0 * run.modal[1].rms_mm);
}

}  // namespace
}  // namespace flexarm
