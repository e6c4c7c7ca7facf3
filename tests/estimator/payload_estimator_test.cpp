// The payload filter behind the decoders, as used in the loop.

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

DecodedCounters JointAngles(double th1, double th2, std::uint32_t good = 0b1111) {
  DecodedCounters counters{};
  counters.angle_rad = {th1, th2, th1, th2};
  counters.good = good;
  return counters;
}

FittedModes BendWith(const std::array<double, 4>& modal, bool valid = true) {
  FittedModes modes{};
  modes.modal_m = modal;
  modes.valid = {valid, valid};
  return modes;
}

PiecewiseTorque Held(double u1, double u2) { return PiecewiseTorque::WholePeriod({u1, u2}); }

TEST(PayloadEstimator, StartsAtRestAtTheMeasuredHubAngles) {
  PayloadEstimator estimator = Estimator();
  estimator.Update(JointAngles(0.4, -0.3), BendWith({}), Held(0.0, 0.0));
  PayloadEstimator::State expected = PayloadEstimator::State::Zero();
  expected.head<2>() << 0.4, -0.3;
  EXPECT_LT((estimator.Now() - expected).norm(), 1e-12);
  EXPECT_EQ(estimator.estimate().payload_kg, 0.2);
  estimator.Update(JointAngles(0.5, -0.3), BendWith({}), Held(0.0, 0.0));
  estimator.Reset();
  estimator.Update(JointAngles(-0.1, 0.2), BendWith({}), Held(0.0, 0.0));
  EXPECT_NEAR(estimator.Now()[0], -0.1, 1e-12);
}

// A loop is reset when a run begins, whereas the arm has been at rest for long: one count of a
// hub's encoder must not look like more motion than to a filter that had followed the rest.
TEST(PayloadEstimator, IsAsCertainAfterAResetAsAfterARest) {
  const double count_rad = 2.0 * M_PI / 2540.0;
  PayloadEstimator fresh = Estimator(), rested = Estimator();
  fresh.Update(JointAngles(0.0, 0.0), BendWith({}), Held(0.0, 0.0));
  for (int k = 0; k < 300; ++k) rested.Update(JointAngles(0.0, 0.0), BendWith({}), Held(0.0, 0.0));
  for (auto* estimator : {&fresh, &rested}) {
    estimator->Update(JointAngles(count_rad, 0.0), BendWith({}), Held(0.0, 0.0));
  }
  const double fresh_rad_s = fresh.Now()[6], rested_rad_s = rested.Now()[6];
  EXPECT_GT(rested_rad_s, 0.01) << "the count had no effect";
  EXPECT_NEAR(fresh_rad_s, rested_rad_s, 0.02 * rested_rad_s);
}

// The joints' friction may hold a bend.
TEST(PayloadEstimator, StartsWithTheBendThatTheGaugesRead) {
  PayloadEstimator estimator = Estimator();
  estimator.Update(JointAngles(0.0, 0.0), BendWith({0.004, 0.0, -0.002, 0.0}), Held(0.0, 0.0));
  EXPECT_NEAR(estimator.Now()[2], 0.004, 2e-4);  // it starts to swing back in this sample
  EXPECT_NEAR(estimator.Now()[4], -0.002, 2e-4);
  PayloadEstimator unread = Estimator();
  unread.Update(JointAngles(0.0, 0.0), BendWith({0.004, 0.0, -0.002, 0.0}, false), Held(0.0, 0.0));
  EXPECT_EQ(unread.Now()[2], 0.0);
}

// An input that is not good may have any value.
TEST(PayloadEstimator, AnInputThatIsNotGoodIsIgnored) {
  PayloadEstimator clean = Estimator(), garbage = Estimator();
  for (auto* estimator : {&clean, &garbage}) {
    estimator->Update(JointAngles(0.0, 0.0), BendWith({}), Held(0.0, 0.0));
  }
  constexpr std::uint32_t kHubsOnly = 0b0011;
  DecodedCounters wrong = JointAngles(0.001, 0.002, kHubsOnly);
  wrong.angle_rad[2] = wrong.angle_rad[3] = 7.0;
  clean.Update(JointAngles(0.001, 0.002, kHubsOnly), BendWith({}, false), Held(1.0, 0.2));
  garbage.Update(wrong, BendWith({1.0, 1.0, 1.0, 1.0}, false), Held(1.0, 0.2));
  EXPECT_EQ(clean.Now(), garbage.Now());
  EXPECT_EQ(clean.estimate().nis, garbage.estimate().nis);
  EXPECT_GT((clean.Now() - Estimator().Now()).norm(), 1e-4) << "the inputs had no effect";
}

// Without any input the filter predicts, by the same model as After.
TEST(PayloadEstimator, ALostFrameLeavesThePredictionOnly) {
  PayloadEstimator estimator = Estimator();
  estimator.Update(JointAngles(0.0, 0.0), BendWith({}), Held(0.0, 0.0));
  const PayloadEstimator::State predicted = estimator.After(Held(2.0, 0.4));
  estimator.Update(JointAngles(9.0, 9.0, 0), BendWith({}, false), Held(2.0, 0.4));
  EXPECT_EQ(estimator.Now(), predicted);
}

// Two pieces act one after the other for their durations; equal ones are one piece.
TEST(PayloadEstimator, PiecesOfTorqueActOneAfterTheOther) {
  PayloadEstimator estimator = Estimator();
  estimator.Update(JointAngles(0.0, 0.0), BendWith({}), Held(0.0, 0.0));
  PiecewiseTorque halves, mixed, quarter;
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

// An arm that equals the filter's model, driven by torques that act `late` samples later than
// declared.
class LateArm {
 public:
  explicit LateArm(int late) : late_(late) {}

  /// @returns the estimated delay after `samples`
  int Run(int samples, PayloadEstimator* estimator) {
    for (int k = next_; k < next_ + samples; ++k) {
      const PiecewiseTorque acting = Torque(k - late_);
      x_ =
          estimator->stepper().Advance(x_, {.torque_nm = {acting.last_nm()[0], acting.last_nm()[1]},
                                            .payload_kg = 0.2,
                                            .friction_nm = StudyPayload().friction_start_nm});
      estimator->Update(JointAngles(x_.q[0], x_.q[1]),
                        BendWith({x_.phi_f[0], x_.phi_f[1], x_.phi_f[2], x_.phi_f[3]}),
                        TorqueByDelay{Torque(k + 1), Torque(k), Torque(k - 1), Torque(k - 2)});
    }
    next_ += samples;
    return estimator->delay_found();
  }

 private:
  static PiecewiseTorque Torque(int k) {
    const double s = k < 0 ? 0.0 : std::sin(2.0 * M_PI * k / 50.0);
    return Held(4.0 * s, 0.6 * s);
  }

  int late_, next_ = 0;
  GaugedState x_{.q = RigidJointArm::Vector::Zero(),
                 .v = RigidJointArm::Vector::Zero(),
                 .phi_f = Eigen::Vector4d::Zero()};
};

// Rotors are at the hub angles: the arm's joints are rigid, and the estimator subtracts u/K.
TEST(PayloadEstimator, EstimatesTheUndeclaredDelayWhileTheArmMoves) {
  for (const int late : {-1, 0, 1, 2}) {
    PayloadEstimator estimator = Estimator();
    LateArm arm(late);
    EXPECT_EQ(arm.Run(50, &estimator), late);
    EXPECT_EQ(arm.Run(100, &estimator), late) << "the estimate stays";
  }
}

TEST(PayloadEstimator, ANewDelayEstimateResetsThePayloadEstimate) {
  PayloadEstimator estimator = Estimator();
  LateArm arm(1);
  double sigma_kg = estimator.estimate().payload_sigma_kg;
  int k = 0;
  for (; estimator.delay_found() == 0; ++k) {
    ASSERT_LT(k, 50);
    sigma_kg = estimator.estimate().payload_sigma_kg;
    arm.Run(1, &estimator);
  }
  EXPECT_LT(sigma_kg, 0.39) << "the payload was not estimated";
  EXPECT_EQ(estimator.estimate().payload_kg, 0.2);
  EXPECT_EQ(estimator.estimate().payload_sigma_kg, 0.4);
  estimator.Reset();
  EXPECT_EQ(estimator.delay_found(), 0);
}

// A hypothesis without torque is never used, and no hypothesis is tested without a frame.
TEST(PayloadEstimator, UsesTheTorqueOfTheCurrentDelayHypothesis) {
  PayloadEstimator estimator = Estimator(), alone = Estimator();
  for (int k = 0; k < 5; ++k) {
    const PiecewiseTorque torque = Held(1.0 + k, 0.2);
    estimator.Update(JointAngles(0.0, 0.0), BendWith({}),
                     TorqueByDelay{std::nullopt, torque, Held(9.0, 2.0), std::nullopt});
    alone.Update(JointAngles(0.0, 0.0), BendWith({}), torque);
    ASSERT_EQ(estimator.delay_found(), 0);
    EXPECT_EQ(estimator.Now(), alone.Now());
  }
  for (int k = 0; k < 50; ++k) {
    estimator.Update(JointAngles(0.0, 0.0, 0), BendWith({}, false),
                     TorqueByDelay{Held(0.0, 0.0), Held(6.0, 1.0), Held(0.0, 0.0), Held(0.0, 0.0)});
  }
  EXPECT_EQ(estimator.delay_found(), 0);
}

TEST(PayloadModel, IsReproducedFromItsConstantsToTheBit) {
  const std::vector<double> constants = Model();
  const std::vector<double> again = RigidJointStepper(constants).Constants();
  ASSERT_EQ(again.size(), constants.size());
  EXPECT_EQ(std::memcmp(again.data(), constants.data(), sizeof(double) * constants.size()), 0);
  for (const std::size_t size : {std::size_t{0}, std::size_t{2}, constants.size() - 1}) {
    EXPECT_THROW(RigidJointStepper(std::span(constants).first(size)), std::invalid_argument)
        << size;
  }
}

TEST(PayloadEstimator, ReportsTheRatesOfTheGauges) {
  PayloadEstimator estimator = Estimator();
  for (int k = 0; k < 10; ++k) {
    estimator.Update(JointAngles(0.0, 0.0, 0), BendWith({}, false), Held(2.0, 0.4));
  }
  const GaugedState& x = estimator.estimate().state;
  constexpr double kCorner_rad_s = 2.0 * M_PI * 20.0;
  for (int i = 0; i < 4; ++i) {
    // phi_f' = w_f (phi - phi_f); gauge_share is w_f h to first order, 15 % less.
    const double expected = kCorner_rad_s * (x.q[2 + i] - x.phi_f[i]);
    EXPECT_NEAR(estimator.ModalRates()[static_cast<std::size_t>(i)] / expected, 0.93, 0.08) << i;
  }
}

}  // namespace
}  // namespace flexarm
