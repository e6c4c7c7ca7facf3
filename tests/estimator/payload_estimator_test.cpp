// The payload filter behind the decoders, as the loop uses it.

#include "estimator/payload_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "tests/support/study_payload.h"

namespace flexarm {
namespace {

std::vector<double> Model() {
  return PayloadModelConstants(ThesisRig(), ThesisSensors(), kPeriod_s);
}

PayloadEstimator Estimator() { return {Model(), StudyPayload()}; }

DecodedCounters Angles(double th1, double th2, std::uint32_t good = 0b1111) {
  DecodedCounters counters{};
  counters.angle_rad = {th1, th2, th1, th2};
  counters.good = good;
  return counters;
}

FittedModes Bend(const std::array<double, 4>& modal, bool valid = true) {
  FittedModes modes{};
  modes.modal_m = modal;
  modes.valid = {valid, valid};
  return modes;
}

TorquePieces Held(double u1, double u2) { return TorquePieces::WholePeriod({u1, u2}); }

TEST(PayloadEstimator, StartsAtRestWhereTheHubsAre) {
  PayloadEstimator estimator = Estimator();
  estimator.Update(Angles(0.4, -0.3), Bend({}), Held(0.0, 0.0));
  PayloadEstimator::State expected = PayloadEstimator::State::Zero();
  expected.head<2>() << 0.4, -0.3;
  EXPECT_LT((estimator.Now() - expected).norm(), 1e-12);
  EXPECT_EQ(estimator.estimate().payload_kg, 0.2);
  estimator.Update(Angles(0.5, -0.3), Bend({}), Held(0.0, 0.0));
  estimator.Reset();
  estimator.Update(Angles(-0.1, 0.2), Bend({}), Held(0.0, 0.0));
  EXPECT_NEAR(estimator.Now()[0], -0.1, 1e-12);
}

// What is not good may hold anything.
TEST(PayloadEstimator, AnInputThatIsNotGoodCountsForNothing) {
  PayloadEstimator clean = Estimator(), garbage = Estimator();
  for (auto* estimator : {&clean, &garbage}) {
    estimator->Update(Angles(0.0, 0.0), Bend({}), Held(0.0, 0.0));
  }
  constexpr std::uint32_t kHubsOnly = 0b0011;
  DecodedCounters wrong = Angles(0.001, 0.002, kHubsOnly);
  wrong.angle_rad[2] = wrong.angle_rad[3] = 7.0;
  clean.Update(Angles(0.001, 0.002, kHubsOnly), Bend({}, false), Held(1.0, 0.2));
  garbage.Update(wrong, Bend({1.0, 1.0, 1.0, 1.0}, false), Held(1.0, 0.2));
  EXPECT_EQ(clean.Now(), garbage.Now());
  EXPECT_EQ(clean.estimate().nis, garbage.estimate().nis);
  EXPECT_GT((clean.Now() - Estimator().Now()).norm(), 1e-4) << "nothing was read at all";
}

// Without any input the filter predicts, with the same model as After.
TEST(PayloadEstimator, ALostFrameIsPredicted) {
  PayloadEstimator estimator = Estimator();
  estimator.Update(Angles(0.0, 0.0), Bend({}), Held(0.0, 0.0));
  const PayloadEstimator::State predicted = estimator.After(Held(2.0, 0.4));
  estimator.Update(Angles(9.0, 9.0, 0), Bend({}, false), Held(2.0, 0.4));
  EXPECT_EQ(estimator.Now(), predicted);
}

// Two pieces are the first for its time, then the second; equal ones are one.
TEST(PayloadEstimator, PiecesOfTorqueActOneAfterTheOther) {
  PayloadEstimator estimator = Estimator();
  estimator.Update(Angles(0.0, 0.0), Bend({}), Held(0.0, 0.0));
  TorquePieces halves, mixed, quarter;
  halves.Add({.torque_nm = {2.0, 0.4}, .ticks = kPeriodTicks / 2});
  halves.Add({.torque_nm = {2.0, 0.4}, .ticks = kPeriodTicks / 2});
  EXPECT_EQ(estimator.After(halves), estimator.After(Held(2.0, 0.4)));
  mixed.Add({.torque_nm = {2.0, 0.4}, .ticks = kPeriodTicks / 4});
  mixed.Add({.torque_nm = {-1.0, 0.1}, .ticks = 3 * kPeriodTicks / 4});
  quarter.Add({.torque_nm = {2.0, 0.4}, .ticks = kPeriodTicks / 4});
  const RigidJointStepper& stepper = estimator.stepper();
  GaugedState x = estimator.estimate().state;
  const SampleInputs first{.torque_nm = {2.0, 0.4},
                           .payload_kg = estimator.estimate().payload_kg,
                           .friction_nm = estimator.estimate().friction_nm};
  SampleInputs second = first;
  second.torque_nm << -1.0, 0.1;
  x = stepper.Advance(x, first, 2);
  EXPECT_EQ(estimator.After(quarter).head<6>(), x.q);
  x = stepper.Advance(x, second, 6);
  EXPECT_EQ(estimator.After(mixed).head<6>(), x.q);
  EXPECT_EQ(estimator.After(mixed).tail<6>(), x.v);
}

TEST(PayloadModel, ComesBackFromItsConstantsToTheBit) {
  const std::vector<double> constants = Model();
  const std::vector<double> again = RigidJointStepper(constants).Constants();
  ASSERT_EQ(again.size(), constants.size());
  EXPECT_EQ(std::memcmp(again.data(), constants.data(), sizeof(double) * constants.size()), 0);
  for (const std::size_t size : {std::size_t{0}, std::size_t{2}, constants.size() - 1}) {
    EXPECT_THROW(RigidJointStepper(std::span(constants).first(size)), std::invalid_argument)
        << size;
  }
}

TEST(PayloadEstimator, TellsHowFastTheGaugesChange) {
  PayloadEstimator estimator = Estimator();
  for (int k = 0; k < 10; ++k) {
    estimator.Update(Angles(0.0, 0.0, 0), Bend({}, false), Held(2.0, 0.4));
  }
  const GaugedState& x = estimator.estimate().state;
  constexpr double kCorner_rad_s = 2.0 * M_PI * 20.0;
  for (int i = 0; i < 4; ++i) {
    // phi_f' = w_f (phi - phi_f); the share of a step is w_f h to first order, 15 % less.
    const double expected = kCorner_rad_s * (x.q[2 + i] - x.phi_f[i]);
    EXPECT_NEAR(estimator.ModalRates()[static_cast<std::size_t>(i)] / expected, 0.93, 0.08) << i;
  }
}

}  // namespace
}  // namespace flexarm
