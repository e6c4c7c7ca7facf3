// The fit against strain that ArmModel::Strain computes independently, and against the theory of
// least squares.

#include "estimator/strain_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <cstdio>
#include <random>

#include "model/arm/arm_model.h"
#include "model/math/dense_decompositions.h"
#include "tests/estimator/thesis_estimator.h"

namespace flexarm {
namespace {

const std::array<double, 4> kBend = {0.05, 2e-4, -0.03, 1e-3};  // f11 f12 f21 f22, m

// 24 bits over the same volts: a count is 2.4e-10 of strain, so rounding is negligible.
SensorConfig FineSensors() {
  SensorConfig sensors = ThesisSensors();
  sensors.strain_input.converter_bits = 24;
  return sensors;
}

// Unit strain of every channel for the modal coordinates of a two-mode arm (one-mode: f12 = 0).
std::vector<double> Strains(const SensorConfig& sensors, const std::array<double, 4>& modal) {
  const ArmModel arm(ThesisRig(), ModeCount{.link1 = 2, .link2 = 2});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(arm.dof());
  q.tail(4) << modal[0], modal[1], modal[2], modal[3];
  std::vector<double> strains;
  for (const StrainChannelConfig& row : sensors.strain) {
    strains.push_back(arm.Strain(row.link, row.position_m, q));
  }
  return strains;
}

double CountsPerUnit(const SensorConfig& sensors, std::size_t i) {
  return sensors.strain[i].face * sensors.strain[i].gain_v_per_unit /
         sensors.strain_input.volts_per_count();
}

SensorFrame FrameOf(const SensorConfig& sensors, const std::vector<double>& strains) {
  SensorFrame frame{};
  for (std::size_t i = 0; i < strains.size(); ++i) {
    frame.strain[i] = static_cast<std::int32_t>(
        std::lround(strains[i] * CountsPerUnit(sensors, i) + sensors.strain[i].offset_counts));
    frame.strain_valid |= 1u << i;
  }
  return frame;
}

// Half a count of rounding on a channel, 1.2e-10 of strain, against curvatures of 5e-3 (1/m) a
// metre: below 1e-7 m. A swapped mode or link gives an error of centimetres.
constexpr double kRounding_m = 1e-7;

void ExpectRecovered(const SensorConfig& sensors, const EstimatorConfig& config,
                     const std::array<double, 4>& modal) {
  StrainFit fit(ThesisRig(), sensors, config);
  const FittedModes out = fit.Fit(FrameOf(sensors, Strains(sensors, modal)));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(out.modal_m[i], modal[i], kRounding_m) << i;
  EXPECT_TRUE(out.valid[0] && out.valid[1]);
  EXPECT_EQ(out.used, (1u << sensors.strain.size()) - 1u);
  EXPECT_EQ(out.saturated | out.stuck | out.outlier, 0u);
  EXPECT_LT(out.residual[0] + out.residual[1], 1e-9);
  const ArmModel arm(ThesisRig(), ModeCount{.link1 = 2, .link2 = 2});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(arm.dof());
  q.tail(4) << modal[0], modal[1], modal[2], modal[3];
  EXPECT_NEAR(out.root_strain[0], arm.Strain(1, 0.0, q), 1e-9);
  EXPECT_NEAR(out.root_strain[1], arm.Strain(2, 0.0, q), 1e-9);
}

TEST(StrainFit, NoiseFreeStrainReproducesTheModalCoordinates) {
  ExpectRecovered(FineSensors(), ThesisEstimator(), kBend);
  ExpectRecovered(FineSensors(), ThesisEstimator(), {-0.06, -3e-4, 0.02, -5e-4});
}

TEST(StrainFit, FaceGainSignAndOffsetAreTakenIntoAccount) {
  SensorConfig sensors = FineSensors();
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    sensors.strain[i].face = i % 2 == 0 ? 1 : -1;
    sensors.strain[i].gain_v_per_unit = i % 3 == 0 ? -4000.0 : 6000.0;
    sensors.strain[i].offset_counts = 1000.0 * static_cast<double>(i) - 7000.0;
  }
  ExpectRecovered(sensors, ThesisEstimator(), kBend);
}

// The thesis's five half bridges per link: rows of twice the gain.
TEST(StrainFit, FiveHalfBridgesPerLinkAreFiveRows) {
  SensorConfig sensors = FineSensors();
  std::vector<StrainChannelConfig> rows;
  for (std::size_t i = 0; i < sensors.strain.size(); i += 2) rows.push_back(sensors.strain[i]);
  for (StrainChannelConfig& row : rows) row.gain_v_per_unit *= 2.0;
  sensors.strain = rows;
  ExpectRecovered(sensors, ThesisEstimator(), kBend);
}

// A nearly rigid hub section before the flexible part: the strain limit of the link applies where
// the flexible part begins.
TEST(StrainFit, WithAStiffHubSectionTheRootStrainIsThatOfTheFlexiblePart) {
  ArmParameters arm = ThesisRig();
  BeamSection hub = arm.link[0].section[0];
  hub.length_m = 0.1;
  hub.second_moment_m4 *= 1000.0;
  hub.half_thickness_m *= 5.0;
  arm.link[0].section.insert(arm.link[0].section.begin(), hub);
  const ArmModel model(arm, ModeCount{.link1 = 2, .link2 = 2});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dof());
  q.tail(4) << kBend[0], kBend[1], kBend[2], kBend[3];
  const SensorConfig sensors = FineSensors();
  std::vector<double> strains;
  for (const StrainChannelConfig& row : sensors.strain) {
    strains.push_back(model.Strain(row.link, row.position_m, q));
  }
  StrainFit fit(arm, sensors, ThesisEstimator());
  const FittedModes out = fit.Fit(FrameOf(sensors, strains));
  // Just behind the joint of the sections; 1e-9 m changes the strain by 1e-9 of it.
  const double expected = model.Strain(1, 0.1 + 1e-9, q);
  EXPECT_NEAR(out.root_strain[0], expected, 1e-5 * std::abs(expected));
  EXPECT_GT(std::abs(expected), 50.0 * std::abs(model.Strain(1, 0.0, q)));
}

// The thesis's polynomial fits five coefficients, the direct fit uses the mode shapes. Measured:
// the first modes agree to a micrometre; 1.4 % of link 2's second one appears in the first.
TEST(StrainFit, ThePolynomialOfTheThesisApproximatesTheModes) {
  const SensorConfig sensors = FineSensors();
  StrainFit fit(ThesisRig(), sensors, ThesisEstimator(EstimatorKind::kPolynomial));
  const FittedModes first = fit.Fit(FrameOf(sensors, Strains(sensors, {0.05, 0.0, -0.03, 0.0})));
  EXPECT_NEAR(first.modal_m[0], 0.05, 1e-6);
  EXPECT_NEAR(first.modal_m[2], -0.03, 1e-6);
  const FittedModes second = fit.Fit(FrameOf(sensors, Strains(sensors, {0.0, 2e-3, 0.0, 0.01})));
  EXPECT_NEAR(second.modal_m[1], 2e-3, 1e-6);
  EXPECT_NEAR(second.modal_m[2], 0.0143 * 0.01, 1e-6);
  EXPECT_NEAR(second.modal_m[3], 0.01, 2e-5);
  EXPECT_TRUE(second.valid[0] && second.valid[1]);
}

// Without one channel the direct fit is used: the polynomial needs all channels.
TEST(StrainFit, ThePolynomialNeedsAllItsChannels) {
  const SensorConfig sensors = FineSensors();
  StrainFit fit(ThesisRig(), sensors, ThesisEstimator(EstimatorKind::kPolynomial));
  SensorFrame frame = FrameOf(sensors, Strains(sensors, {0.0, 0.0, 0.0, 0.01}));
  frame.strain_valid &= ~(1u << 12);
  EXPECT_NEAR(fit.Fit(frame).modal_m[2], 0.0, kRounding_m);
}

TEST(StrainFit, OneGaugePerLinkFitsOneMode) {
  SensorConfig sensors = FineSensors();
  sensors.strain = {sensors.strain[0], sensors.strain[10]};
  EstimatorConfig config = ThesisEstimator();
  config.modes_per_link = 1;
  ExpectRecovered(sensors, config, {0.05, 0.0, -0.03, 0.0});
}

TEST(StrainFit, OneGaugeForTwoModesIsReportedAsNotValid) {
  SensorConfig sensors = FineSensors();
  sensors.strain.erase(sensors.strain.begin() + 11, sensors.strain.end());  // link 2: one left
  StrainFit fit(ThesisRig(), sensors, ThesisEstimator());
  const FittedModes out = fit.Fit(FrameOf(sensors, Strains(sensors, kBend)));
  EXPECT_TRUE(out.valid[0]);
  EXPECT_FALSE(out.valid[1]);
  EXPECT_NEAR(out.modal_m[0], kBend[0], kRounding_m);
}

TEST(StrainFit, WithoutAReadingTheLastGoodFitIsKeptAndNotValid) {
  const SensorConfig sensors = FineSensors();
  StrainFit fit(ThesisRig(), sensors, ThesisEstimator());
  const SensorFrame frame = FrameOf(sensors, Strains(sensors, kBend));
  const FittedModes before = fit.Fit(frame);
  SensorFrame silent = frame;
  silent.strain_valid = 0;
  const FittedModes after = fit.Fit(silent);
  EXPECT_FALSE(after.valid[0] || after.valid[1]);
  EXPECT_EQ(after.modal_m, before.modal_m);
  EXPECT_EQ(after.used, 0u);
}

// The covariance of least squares, sigma^2 (H'H)^-1 with H the strains of unit coordinates, sigma
// one count of noise and its rounding. 4000 frames: the mean's standard error is its deviation
// / 63, five of them allowed; a variance's is 2.2 %, five of them 11 %, and so for correlations.
TEST(StrainFit, UnderNoiseIsUnbiasedWithTheCovarianceOfLeastSquares) {
  const SensorConfig sensors = ThesisSensors();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(20, 4);
  for (int j = 0; j < 4; ++j) {
    std::array<double, 4> unit{};
    unit[static_cast<std::size_t>(j)] = 1.0;
    const std::vector<double> strains = Strains(sensors, unit);
    for (int i = 0; i < 20; ++i) H(i, j) = strains[static_cast<std::size_t>(i)];
  }
  const double count = 20.0 / 4096.0 / 5000.0;
  const Eigen::Matrix4d expected =
      (1.0 + 1.0 / 12.0) * count * count * (H.transpose() * H).inverse();

  StrainFit fit(ThesisRig(), sensors, ThesisEstimator());
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise;
  const std::vector<double> clean = Strains(sensors, kBend);
  constexpr int kFrames = 4000;
  Eigen::Vector4d mean = Eigen::Vector4d::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  for (int k = 0; k < kFrames; ++k) {
    std::vector<double> strains = clean;
    for (double& strain : strains) strain += count * noise(random);
    const FittedModes out = fit.Fit(FrameOf(sensors, strains));
    ASSERT_EQ(out.outlier, 0u);
    Eigen::Vector4d error;
    for (int j = 0; j < 4; ++j) {
      const auto i = static_cast<std::size_t>(j);
      error(j) = out.modal_m[i] - kBend[i];
    }
    mean += error / kFrames;
    covariance += error * error.transpose() / kFrames;
  }
  for (int i = 0; i < 4; ++i) {
    const double deviation = std::sqrt(expected(i, i));
    EXPECT_NEAR(mean(i), 0.0, 5.0 * deviation / std::sqrt(kFrames)) << i;
    for (int j = 0; j < 4; ++j) {
      const double scale = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(covariance(i, j) / scale, expected(i, j) / scale, 0.11) << i << j;
    }
  }
}

// Weights: a channel of a tenth of the gain has a hundred times the variance, and must get that
// much less weight. An error of 20 counts on that channel changes the fit by a hundredth of the
// effect of an equal strain error on a good one.
TEST(StrainFit, AChannelIsWeightedByTheInverseOfItsVariance) {
  const auto moved = [](double gain) {
    SensorConfig sensors = FineSensors();
    sensors.strain[2].gain_v_per_unit = gain;
    std::vector<double> strains = Strains(sensors, kBend);
    strains[2] += 1e-4;
    StrainFit fit(ThesisRig(), sensors, ThesisEstimator());
    return fit.Fit(FrameOf(sensors, strains)).modal_m[0] - kBend[0];
  };
  // Not exactly 1/100: the weak channel also changes the weight of the others. Its leverage is
  // below 0.4, so the ratio lies between 1/100 and 1/60.
  const double ratio = moved(500.0) / moved(5000.0);
  EXPECT_GT(ratio, 0.009);
  EXPECT_LT(ratio, 0.02);
}

// A channel with a zero and a gain of its own reads the same strain once both are known.
TEST(StrainFit, ACalibratedChannelReadsTheTrueStrain) {
  const SensorConfig sensors = FineSensors();
  SensorFrame frame = FrameOf(sensors, Strains(sensors, kBend));
  Calibration calibration{};
  calibration.strain_zero_counts[4] = 1'000.0f;
  calibration.strain_gain_error[4] = 0.125f;  // exact in binary, as the product below
  frame.strain[4] = static_cast<std::int32_t>(std::lround(1.125 * frame.strain[4])) + 1'000;
  StrainFit fit(ThesisRig(), sensors, ThesisEstimator());
  fit.Reset(calibration);
  const FittedModes out = fit.Fit(frame);
  EXPECT_EQ(out.used, 0xFFFFFu);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(out.modal_m[i], kBend[i], kRounding_m) << i;
}

// A multiplexer at 0.25 ms per channel on an arm that vibrates at w. With d_i = i dt and weights
// p_i of the least-squares fit of f11 (the other coordinates at rest), the fit of the readings is
// sum p_i exp(j w d_i) of the amplitude: its error is |sum p_i (exp(j w d_i) - 1)|, and after the
// skew correction |sum p_i (exp(j w d_i) - 1 - j w d_i)|. The p_i are computed here from the shapes
// by the normal equations.
class SkewedFit : public testing::TestWithParam<double> {};  // Hz

TEST_P(SkewedFit, TheResidualErrorIsTheCurvature) {
  constexpr double kSkew_s = 0.25e-3, kSwing_m = 0.05;
  const double w = 2.0 * M_PI * GetParam();
  SensorConfig sensors = FineSensors();
  EstimatorConfig config = ThesisEstimator();
  config.strain_family_limit = 1.0;  // skew must not count as a broken channel
  StrainFit fit(ThesisRig(), sensors, config);
  fit.Reset({});
  Eigen::MatrixXd shape(10, 2);
  const std::vector<double> first = Strains(sensors, {1.0, 0.0, 0.0, 0.0}),
                            second = Strains(sensors, {0.0, 1.0, 0.0, 0.0});
  for (Eigen::Index i = 0; i < 10; ++i) {
    shape.row(i) << first[static_cast<std::size_t>(i)], second[static_cast<std::size_t>(i)];
  }
  const Eigen::MatrixXd inverse = (shape.transpose() * shape).inverse() * shape.transpose();
  std::complex<double> raw = 0.0, moved = 0.0;
  for (Eigen::Index i = 0; i < 10; ++i) {
    const double p = inverse(0, i) * shape(i, 0), wd = w * kSkew_s * static_cast<double>(i);
    raw += p * (std::polar(1.0, wd) - 1.0);
    moved += p * (std::polar(1.0, wd) - 1.0 - std::complex<double>(0.0, wd));
  }
  double worst_raw = 0.0, worst_moved = 0.0;
  for (int k = 0; k < 360; ++k) {
    const double t = 2.0 * M_PI / w * k / 360.0, f11 = kSwing_m * std::sin(w * t);
    std::vector<double> strains(20, 0.0);
    for (std::size_t i = 0; i < 10; ++i) {
      strains[i] = kSwing_m * std::sin(w * (t + kSkew_s * static_cast<double>(i))) * first[i];
    }
    SensorFrame frame = FrameOf(sensors, strains);
    for (std::size_t i = 0; i < 20; ++i) {
      frame.strain_offset_ns[i] = static_cast<std::int32_t>(250'000 * i);
    }
    const double rate = kSwing_m * w * std::cos(w * t);
    worst_raw = std::max(worst_raw, std::abs(fit.Fit(frame).modal_m[0] - f11));
    worst_moved =
        std::max(worst_moved, std::abs(fit.Fit(frame, 0, {rate, 0.0, 0.0, 0.0}).modal_m[0] - f11));
  }
  std::printf("  %4.1f Hz: error %.2f %% of the amplitude, skew-corrected %.3f %%\n", GetParam(),
              100.0 * worst_raw / kSwing_m, 100.0 * worst_moved / kSwing_m);
  // The grid of 360 phases contains the peak within 4e-5 of it; rounding as above.
  EXPECT_NEAR(worst_raw, std::abs(raw) * kSwing_m, 1e-4 * worst_raw + kRounding_m);
  EXPECT_NEAR(worst_moved, std::abs(moved) * kSwing_m, 1e-4 * worst_moved + kRounding_m);
  EXPECT_LT(worst_moved, 0.2 * worst_raw);
}

INSTANTIATE_TEST_SUITE_P(Frequencies, SkewedFit, testing::Values(1.0, 6.7, 8.8, 17.4),
                         [](const auto& shown) {
                           return "MilliHertz" + std::to_string(std::lround(1e3 * shown.param));
                         });

// Only the instant of a reading matters, not its split into frame instant and offset.
TEST(StrainFit, AFrameThatIsLateAsAWholeIsCorrectedAsAWhole) {
  const SensorConfig sensors = FineSensors();
  StrainFit fit(ThesisRig(), sensors, ThesisEstimator());
  fit.Reset({});
  SensorFrame frame = FrameOf(sensors, Strains(sensors, kBend));
  frame.sampled_at_ns = 3'000'000;
  const std::array<double, 4> rate = {0.5, 0.01, -0.4, 0.02};
  const FittedModes modes = fit.Fit(frame, 1'000'000, rate);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(modes.modal_m[i], kBend[i] - 2e-3 * rate[i], kRounding_m) << i;
  }
}

}  // namespace
}  // namespace flexarm
