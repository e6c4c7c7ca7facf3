#include "estimator/state_estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "hal/gauge_filter.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "tests/estimator/estimator_inputs.h"

namespace flexarm {
namespace {

StateEstimator Difference() {
  return {ThesisEstimator(EstimatorKind::kDifference), GainsOf(ThesisFilter()), kPeriod_s,
          kStiffness};
}

TEST(KalmanFilter, StartsFromItsFirstMeasurementAtRest) {
  StateEstimator estimator = Kalman(ThesisFilter());
  const auto out =
      estimator.Update(Angles(0.3, -0.2, 0.3, -0.2), Bend({0.01, 1e-3, 0.02, -1e-3}), {0.0, 0.0});
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(12);
  expected.head<6>() << 0.3, -0.2, 0.01, 1e-3, 0.02, -1e-3;
  EXPECT_EQ((out.x - expected).cwiseAbs().maxCoeff(), 0.0);
}

// With the outputs of its own model the innovation is zero: any wrong term of the prediction makes
// it non-zero. Round-off of 200 products of numbers up to 50: 1e-12 measured below.
TEST(KalmanFilter, OnItsOwnModelWithoutNoiseTheInnovationsVanish) {
  const KalmanDesign design = ThesisFilter();
  StateEstimator estimator = Kalman(design);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(16);
  std::array<double, 2> torque = {0.0, 0.0};
  for (int k = 0; k < 200; ++k) {
    const Eigen::VectorXd y = design.C * x;
    // The rotors lead their hubs by the torsion of the last interval's torque.
    const auto out = estimator.Update(
        Angles(y(0), y(1), y(2) + torque[0] / kStiffness[0], y(3) + torque[1] / kStiffness[1]),
        Bend({y(4), y(5), y(6), y(7)}), torque);
    for (const double innovation : out.innovation) EXPECT_NEAR(innovation, 0.0, 1e-9);
    for (Eigen::Index i = 0; i < 12; ++i) {
      EXPECT_NEAR(out.x(i), x(i), 1e-9 * (1.0 + std::abs(x(i)))) << "state " << i << " at " << k;
    }
    torque = {4.0 * std::sin(0.1 * k), 0.5 * std::cos(0.2 * k)};
    x = design.A * x + design.B * Eigen::Vector2d(torque[0], torque[1]);
  }
}

// With torsional joints the rotor output is the rotor angle itself, without the correction u/K.
class TorsionalFilter : public testing::TestWithParam<StateLayout> {};
INSTANTIATE_TEST_SUITE_P(NominalModels, TorsionalFilter, testing::Values(kT12, kT16),
                         [](const auto& shown) { return std::string(NameOf(shown.param)); });

TEST_P(TorsionalFilter, OnItsOwnModelWithoutNoiseTheInnovationsVanish) {
  const StateLayout layout = GetParam();
  const KalmanDesign design = ThesisFilter(ThesisSensors(), layout);
  StateEstimator estimator = Kalman(design, layout);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(design.A.rows());
  std::array<double, 2> torque = {0.0, 0.0};
  for (int k = 0; k < 200; ++k) {
    const Eigen::VectorXd y = design.C * x;
    std::array<double, 4> modal{};
    for (std::size_t i = 0; i < 2; ++i) {
      for (int j = 0; j < layout.modes_per_link; ++j) {
        modal[2 * i + static_cast<std::size_t>(j)] =
            y(4 + static_cast<int>(i) * layout.modes_per_link + j);
      }
    }
    const auto out = estimator.Update(Angles(y(0), y(1), y(2), y(3)), Bend(modal), torque);
    for (const double innovation : out.innovation) EXPECT_NEAR(innovation, 0.0, 1e-9);
    ASSERT_EQ(out.x.size(), layout.states());
    for (Eigen::Index i = 0; i < layout.states(); ++i) {
      EXPECT_NEAR(out.x(i), x(i), 1e-9 * (1.0 + std::abs(x(i)))) << "state " << i << " at " << k;
    }
    torque = {4.0 * std::sin(0.1 * k), 0.5 * std::cos(0.2 * k)};
    x = design.A * x + design.B * Eigen::Vector2d(torque[0], torque[1]);
  }
}

TEST_P(TorsionalFilter, StartsWithUntwistedJoints) {
  const StateLayout layout = GetParam();
  StateEstimator estimator = Kalman(ThesisFilter(ThesisSensors(), layout), layout);
  const auto out =
      estimator.Update(Angles(0.3, -0.2, 0.4, -0.1), Bend({0.01, 1e-3, 0.02, -1e-3}), {0.0, 0.0});
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(layout.states());
  expected.head<4>() << 0.3, -0.2, 0.3, -0.2;
  expected(layout.mode(0, 0)) = 0.01;
  expected(layout.mode(1, 0)) = 0.02;
  if (layout.modes_per_link == 2) {
    expected(layout.mode(0, 1)) = 1e-3;
    expected(layout.mode(1, 1)) = -1e-3;
  }
  EXPECT_EQ((out.x - expected).cwiseAbs().maxCoeff(), 0.0);
}

// The rotors act on the hubs through the springs, so a filter works without rotor encoders.
TEST_P(TorsionalFilter, NeedsNoRotorEncoders) {
  SensorConfig hubs_only = ThesisSensors();
  hubs_only.encoder.resize(2);
  const KalmanDesign design = ThesisFilter(hubs_only, GetParam());
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(design.A.rows(), design.A.rows());
  const Eigen::MatrixXd error = design.A * (I - design.L * design.C);
  EXPECT_LT(error.eigenvalues().cwiseAbs().maxCoeff(), 1.0);
  EXPECT_EQ(design.L.middleCols(2, 2).cwiseAbs().maxCoeff(), 0.0);
}

TEST_P(TorsionalFilter, WithoutAnyEncoderIsRejectedNamingTheModel) {
  SensorConfig none = ThesisSensors();
  none.encoder.clear();
  try {
    ThesisFilter(none, GetParam());
    ADD_FAILURE() << "the gauges do not measure the angle of the arm";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(NameOf(GetParam())), std::string::npos)
        << error.what();
  }
}

// The filter in the design against the filter of the simulated rig, in small steps with the nominal
// model. Holding the input over a step of 2e-5 s errs by 4e-6 of the peak; measured at most
// 2e-8 of it, as the middle of the step is used; 1e-5 allowed.
TEST(KalmanFilter, HasASecondOrderGaugeFilterInItsModel) {
  SensorConfig sensors = ThesisSensors();
  sensors.strain_input.filter_hz = 4.0;
  sensors.strain_input.filter_damping = 0.9;
  const KalmanDesign design = ThesisFilter(sensors);
  ASSERT_EQ(design.A.rows(), 20);
  EXPECT_LT((design.A - design.A * design.L * design.C).eigenvalues().cwiseAbs().maxCoeff(), 1.0);

  const NominalModel nominal = MakeNominalModel(ThesisRig(), kR12);
  constexpr int kSteps = 1000;
  const DiscreteModel fine = ZeroOrderHold(nominal.A, nominal.B, kPeriod_s / kSteps);
  GaugeFilter filter(sensors.strain_input, kPeriod_s / kSteps, 4);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(20), state = Eigen::VectorXd::Zero(12);
  const Eigen::Vector2d torque(3.0, -0.4);
  double worst = 0.0, peak = 0.0;
  for (int k = 0; k < 20; ++k) {
    x = design.A * x + design.B * torque;
    for (int i = 0; i < kSteps; ++i) {
      state = fine.A * state + fine.B * torque;
      filter.Step(state.segment<4>(2));
    }
    const Eigen::VectorXd seen = (design.C * x).tail<4>();
    worst = std::max(worst, (seen - filter.output()).cwiseAbs().maxCoeff());
    peak = std::max(peak, seen.cwiseAbs().maxCoeff());
  }
  EXPECT_GT(peak, 1e-2);
  EXPECT_LT(worst, 1e-5 * peak);
}

TEST(KalmanFilter, WithoutAnyMeasurementTheEstimateIsThePrediction) {
  const KalmanDesign design = ThesisFilter();
  StateEstimator estimator = Kalman(design);
  estimator.Update(Angles(0.1, 0.2, 0.1, 0.2), Bend({0.03, 0.0, 0.01, 0.0}), {0.0, 0.0});
  Eigen::VectorXd x = Eigen::VectorXd::Zero(16);
  x << 0.1, 0.2, 0.03, 0.0, 0.01, 0.0, 0, 0, 0, 0, 0, 0, 0.03, 0.0, 0.01, 0.0;
  for (int k = 0; k < 5; ++k) {
    DecodedCounters none = Angles(9.0, 9.0, 9.0, 9.0);
    none.good = 0;
    FittedModes invalid = Bend({9.0, 9.0, 9.0, 9.0});
    invalid.valid = {false, false};
    const auto out = estimator.Update(none, invalid, {1.0, -0.1});
    x = design.A * x + design.B * Eigen::Vector2d(1.0, -0.1);
    EXPECT_LT((out.x - x.head(12)).cwiseAbs().maxCoeff(), 1e-12);
    for (const double innovation : out.innovation) EXPECT_EQ(innovation, 0.0);
  }
}

// A torque that changes within the period: the time update advances over both pieces, each by a
// hold of exactly its length. The mean torque has the right impulse at the wrong time: the hubs are
// light and the links vibrate, so it errs by 2.2e-3 rad in th1, a count, and by 0.5 rad/s in its
// rate.
TEST(KalmanFilter, ATorqueThatChangesWithinThePeriodIsIntegratedPiecewise) {
  const KalmanDesign design = ThesisFilter();
  StateEstimator estimator = Kalman(design), by_mean = Kalman(design);
  const std::array<double, 2> before = {2.0, -0.3}, after = {0.0, 0.3};
  PiecewiseTorque pieces;
  pieces.Add({.torque_nm = before, .ticks = kPeriodTicks * 3 / 10});
  pieces.Add({.torque_nm = after, .ticks = kPeriodTicks - kPeriodTicks * 3 / 10});
  DecodedCounters none{};
  FittedModes invalid{};
  for (StateEstimator* start : {&estimator, &by_mean}) {
    start->Update(Angles(0, 0, 0, 0), Bend({}), {0.0, 0.0});
  }
  const auto out = estimator.Update(none, invalid, pieces);
  const auto mean = by_mean.Update(none, invalid, {0.6, 0.12});
  Eigen::VectorXd x = Eigen::VectorXd::Zero(16);
  constexpr auto kFirstTicks = kPeriodTicks * 3 / 10;
  const double first_s = kPeriod_s * static_cast<double>(kFirstTicks) / kPeriodTicks;
  const DiscreteModel first = ZeroOrderHold(design.A_rate, design.B_rate, first_s),
                      second = ZeroOrderHold(design.A_rate, design.B_rate, kPeriod_s - first_s);
  x = first.A * x + first.B * Eigen::Vector2d(before[0], before[1]);
  x = second.A * x + second.B * Eigen::Vector2d(after[0], after[1]);
  EXPECT_LT((out.x - x.head(12)).cwiseAbs().maxCoeff(),
            1e-11);  // as in fractional_zero_order_hold_test
  const Eigen::VectorXd missed = (mean.x - x.head(12)).cwiseAbs();
  EXPECT_NEAR(missed(0), 2.2e-3, 1e-4);
  EXPECT_NEAR(missed(6), 0.48, 0.02);
}

// Gain of the optimal filter for the rows `seen` of C, from the covariance P of the prediction; P
// becomes that of the next prediction, without process noise if a row is missing.
Eigen::MatrixXd OptimalGain(const KalmanDesign& design, const std::vector<Eigen::Index>& seen,
                            Eigen::MatrixXd* P) {
  const Eigen::MatrixXd C = design.C(seen, Eigen::all);
  const Eigen::VectorXd variance = design.R(seen);
  Eigen::MatrixXd S = C * *P * C.transpose();
  S.diagonal() += variance;
  const Eigen::MatrixXd K = (S.ldlt().solve(C * *P)).transpose();
  const Eigen::MatrixXd corrected = *P - K * C * *P;
  *P = design.A * corrected * design.A.transpose();
  if (static_cast<Eigen::Index>(seen.size()) == design.C.rows()) *P += design.W;
  return K;
}

// A sample without some outputs is corrected by the others with the gain of exactly these, and the
// next one with a gain that allows for the loss. From rest at zero the first prediction is zero.
TEST(KalmanFilter, ASampleWithoutAnOutputHasTheGainOfTheOthers) {
  const KalmanDesign design = ThesisFilter();
  Eigen::VectorXd y(8);
  y << 0.01, 0.02, 0.011, 0.021, 1e-3, 1e-4, 2e-3, 2e-4;
  for (Eigen::Index lost = 0; lost < 6; ++lost) {  // counters, then links
    StateEstimator estimator = Kalman(design);
    estimator.Update(Angles(0, 0, 0, 0), Bend({}), {0.0, 0.0});
    DecodedCounters counters = Angles(y(0), y(1), y(2), y(3));
    FittedModes modes = Bend({y(4), y(5), y(6), y(7)});
    std::vector<Eigen::Index> seen, all;
    for (Eigen::Index i = 0; i < 8; ++i) {
      all.push_back(i);
      if (lost != (i < 4 ? i : i / 2 + 2)) seen.push_back(i);
    }
    if (lost < 4) {
      counters.good &= ~(1u << static_cast<unsigned>(lost));
    } else {  // a link's two coordinates are valid together
      modes.valid[static_cast<std::size_t>(lost - 4)] = false;
      ASSERT_EQ(seen.size(), 6u);
    }
    Eigen::MatrixXd P = design.P;
    const Eigen::VectorXd x = OptimalGain(design, seen, &P) * y(seen);
    const auto out = estimator.Update(counters, modes, {0.0, 0.0});
    EXPECT_LT((out.x - x.head(12)).norm(), 1e-9 * x.head(12).norm()) << lost;
    EXPECT_EQ(out.innovation[0], lost == 0 ? 0.0 : y(0));

    const Eigen::VectorXd predicted = design.A * x;
    const Eigen::VectorXd expected =
        predicted + OptimalGain(design, all, &P) * (y - design.C * predicted);
    const auto next =
        estimator.Update(Angles(y(0), y(1), y(2), y(3)), Bend({y(4), y(5), y(6), y(7)}), {0, 0});
    EXPECT_LT((next.x - expected.head(12)).norm(), 1e-9 * expected.head(12).norm()) << lost;
    const Eigen::VectorXd steady = predicted + design.L * (y - design.C * predicted);
    EXPECT_GT((steady - expected).head(12).norm(), 1e-4 * expected.head(12).norm())
        << "the steady gain would do: the test is inconclusive";
  }
}

TEST(KalmanFilter, AnEncoderThatTheRigLacksIsNotMissing) {
  SensorConfig hubs_only = ThesisSensors();
  hubs_only.encoder.resize(2);
  const KalmanDesign design = ThesisFilter(hubs_only);
  StateEstimator estimator = Kalman(design);
  estimator.Update(Angles(0, 0, 0, 0), Bend({}), {0.0, 0.0});
  DecodedCounters counters = Angles(0.01, 0.02, 0.0, 0.0);
  counters.good = 0b0011;
  EXPECT_NE(estimator.Update(counters, Bend({}), {0.0, 0.0}).x(0), 0.0);
}

struct Loss {
  std::uint32_t counters;  // bit i: counter i is lost
  std::uint32_t links;     // bit i: the strain of link i is lost
};

// Two filters that have the same readings and differ in their state: the difference is the error of
// an estimate. `lost(k)` says what sample k lacks.
template <typename Lost>
double RestOfAnError(const KalmanDesign& design, const StateLayout& layout, int samples,
                     Lost lost) {
  StateEstimator right = Kalman(design, layout), wrong = Kalman(design, layout);
  right.Update(Angles(0, 0, 0, 0), Bend({}), {0.0, 0.0});
  wrong.Update(Angles(0.1, -0.1, 0.1, -0.1), Bend({0.02, 0.002, -0.02, 0.002}), {0.0, 0.0});
  double apart = 0.0;
  for (int k = 0; k < samples; ++k) {
    const Loss loss = lost(k);
    DecodedCounters counters = Angles(0, 0, 0, 0);
    counters.good &= ~loss.counters;
    FittedModes modes = Bend({});
    modes.valid = {(loss.links & 1U) == 0, (loss.links & 2U) == 0};
    const std::array<double, 2> torque = {1.0, -0.2};
    apart = (right.Update(counters, modes, torque).x - wrong.Update(counters, modes, torque).x)
                .cwiseAbs()
                .maxCoeff();
  }
  return apart;
}

// Any outputs, in every second sample for ever, and any outputs at random, not two samples in a
// row: the error of the estimate decays. The steady gain in the complete samples, without a
// correction in the others, makes the error of R12 grow by 1.5 in two samples.
TEST(KalmanFilter, IsStableWhateverSamplesAreLostOneAtATime) {
  std::mt19937 random(3);
  for (const StateLayout& layout : {kR8, kR12, kT12, kT16}) {
    SCOPED_TRACE(NameOf(layout));
    const KalmanDesign design = ThesisFilter(ThesisSensors(), layout);
    for (std::uint32_t bits = 1; bits < 64; ++bits) {
      const Loss loss{.counters = bits & 15U, .links = bits >> 4};
      const auto every_second = [&loss](int k) { return k % 2 == 0 ? loss : Loss{}; };
      const double early = RestOfAnError(design, layout, 100, every_second);
      EXPECT_LT(RestOfAnError(design, layout, 400, every_second), std::max(1e-4, 0.8 * early))
          << bits;
    }
    auto at_random = [&, before = false](int) mutable {
      before = !before && random() % 2 == 0;
      return before ? Loss{.counters = static_cast<std::uint32_t>(random() % 16),
                           .links = static_cast<std::uint32_t>(random() % 4)}
                    : Loss{};
    };
    EXPECT_LT(RestOfAnError(design, layout, 5'000, at_random), 1e-6);
  }
  const KalmanDesign design = ThesisFilter();
  const Eigen::MatrixXd F = (Eigen::MatrixXd::Identity(16, 16) - design.L * design.C) * design.A;
  EXPECT_NEAR((F * design.A).eigenvalues().cwiseAbs().maxCoeff(), 1.52, 0.01);
}

// The gain of a filter after its losses becomes that of one without: the same state to the bit,
// once the covariance counts as settled, up to what the losses left in the state.
TEST(KalmanFilter, AFilterThatHadALossBecomesSteadyAgain) {
  EXPECT_LT(RestOfAnError(ThesisFilter(), kR12, 300, [](int) { return Loss{}; }), 1e-12);
  EXPECT_LT(RestOfAnError(ThesisFilter(), kR12, 300,
                          [](int k) { return Loss{.counters = k == 0 ? 15U : 0U, .links = 0}; }),
            1e-12);
}

TEST(KalmanFilter, TheGainColumnOfAnAbsentEncoderIsZero) {
  SensorConfig hubs_only = ThesisSensors();
  hubs_only.encoder.resize(2);
  const KalmanDesign design = ThesisFilter(hubs_only);
  EXPECT_EQ(design.L.middleCols(2, 2).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_GT(design.L.col(0).cwiseAbs().maxCoeff(), 0.0);
  // The hubs then have larger gains than with rotor encoders.
  const KalmanDesign with = ThesisFilter();
  EXPECT_GT(design.L(0, 0), with.L(0, 0));
  // The filter is still stable.
  const Eigen::MatrixXd error =
      design.A * (Eigen::MatrixXd::Identity(16, 16) - design.L * design.C);
  EXPECT_LT(error.eigenvalues().cwiseAbs().maxCoeff(), 1.0);
}

TEST(DifferenceEstimator, RampsAreExactFromTheSecondSample) {
  StateEstimator estimator = Difference();
  for (int k = 0; k < 5; ++k) {
    const double t = kPeriod_s * k;
    const auto out = estimator.Update(Angles(1.5 * t, -2.0 * t, 1.5 * t, -2.0 * t),
                                      Bend({0.1 * t, 0.01 * t, -0.2 * t, 0.0}), {0.0, 0.0});
    EXPECT_DOUBLE_EQ(out.x(0), 1.5 * t);
    if (k == 0) continue;
    EXPECT_NEAR(out.x(6), 1.5, 1e-12);
    EXPECT_NEAR(out.x(7), -2.0, 1e-12);
    EXPECT_NEAR(out.x(8), 0.1, 1e-12);
    EXPECT_NEAR(out.x(10), -0.2, 1e-12);
  }
}

// The backward difference of sin(w t) is w sinc(w Ts / 2) cos(w (t - Ts / 2)): half a sample late.
TEST(DifferenceEstimator, RatesLagBehindByHalfASample) {
  StateEstimator estimator = Difference();
  const double w = 20.0, half = 0.5 * w * kPeriod_s;
  for (int k = 0; k < 200; ++k) {
    const double t = kPeriod_s * k;
    const double angle = 0.1 * std::sin(w * t);
    const auto out = estimator.Update(Angles(angle, 0, angle, 0), Bend({}), {0.0, 0.0});
    if (k == 0) continue;
    const double late = 0.1 * w * std::sin(half) / half * std::cos(w * (t - 0.5 * kPeriod_s));
    EXPECT_NEAR(out.x(6), late, 1e-12);
  }
}

TEST(DifferenceEstimator, OfATorsionalModelUsesTheRotorAnglesUncorrected) {
  const KalmanDesign design = ThesisFilter(ThesisSensors(), kT12);
  StateEstimator estimator(ThesisEstimator(EstimatorKind::kDifference), GainsOf(design, kT12),
                           kPeriod_s, kStiffness);
  estimator.Update(Angles(0.1, 0.2, 0.1, 0.2), Bend({}), {5.0, 1.0});
  const auto out =
      estimator.Update(Angles(0.1, 0.2, 0.12, 0.17), Bend({1e-3, 9.0, -2e-3, 9.0}), {5.0, 1.0});
  Eigen::VectorXd expected(12);
  expected << 0.1, 0.2, 0.12, 0.17, 1e-3, -2e-3, 0.0, 0.0, 1.0, -1.5, 0.05, -0.1;
  EXPECT_LT((out.x - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(DifferenceEstimator, ALostAngleIsExtrapolatedAtItsLastRate) {
  StateEstimator estimator = Difference();
  for (int k = 0; k < 3; ++k) {
    estimator.Update(Angles(0.01 * k, 0, 0.01 * k, 0), Bend({}), {0.0, 0.0});
  }
  DecodedCounters lost = Angles(0.02, 0, 0.02, 0);
  lost.good = 0b1110;
  const auto out = estimator.Update(lost, Bend({}), {0.0, 0.0});
  EXPECT_NEAR(out.x(0), 0.03, 1e-12);
  EXPECT_NEAR(out.x(6), 0.5, 1e-12);
}

// Every second reading lost: the rate is the mean since the last reading, so that the error of the
// rate that stood in between is forgotten. (A difference from the extrapolated angle would repeat
// it with the other sign for ever.)
TEST(DifferenceEstimator, AReadingAfterALostOneGivesTheMeanRate) {
  StateEstimator estimator = Difference();
  estimator.Update(Angles(0, 0, 0, 0), Bend({}), {0.0, 0.0});
  DecodedCounters lost = Angles(0, 0, 0, 0);
  lost.good = 0b1110;
  FittedModes unfitted = Bend({});
  unfitted.valid[1] = false;
  for (int k = 1; k < 10; ++k) {
    const double turned = 0.02 * k;
    estimator.Update(lost, unfitted, {0.0, 0.0});
    const auto out =
        estimator.Update(Angles(turned, 0, turned, 0), Bend({0, 0, 0.1 * turned, 0}), {0.0, 0.0});
    EXPECT_NEAR(out.x(0), turned, 1e-15);
    EXPECT_NEAR(out.x(6), 0.5, 1e-12);
    EXPECT_NEAR(out.x(10), 0.05, 1e-12);
  }
}

}  // namespace
}  // namespace flexarm
