// Every trip cause of the control step: after how many samples it is raised, with which value,
// limit and channel.

#include "controller/step/fault_detection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "model/units.h"
#include "tests/controller/step/fault_detection_fixture.h"

namespace flexarm {
namespace {

TEST_F(FaultDetectionTest, AHealthyArmRaisesNoFault) {
  for (int k = 0; k < 100; ++k) EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u);
}

TEST_F(FaultDetectionTest, SoftLimitsTripInTheSameSample) {
  for (const double sign : {1.0, -1.0}) {
    Facts facts;
    facts.counters.angle_rad = {sign * 90.1 * kRadPerDeg, 0, sign * 90.1 * kRadPerDeg, 0};
    Expect(TripCause::kSoftLimit1, 1, facts, 90.1 * kRadPerDeg, 90.0 * kRadPerDeg, 1);
    facts.counters.angle_rad = {0, sign * 90.1 * kRadPerDeg, 0, sign * 90.1 * kRadPerDeg};
    Expect(TripCause::kSoftLimit2, 1, facts, 90.1 * kRadPerDeg, 90.0 * kRadPerDeg, 2);
    facts.counters.angle_rad = {sign * 89.9 * kRadPerDeg, sign * 89.9 * kRadPerDeg,
                                sign * 89.9 * kRadPerDeg, sign * 89.9 * kRadPerDeg};
    monitor_.Reset();  // an arm that is there, not one that jumps there
    EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  }
}

TEST_F(FaultDetectionTest, AHubThatDoesNotFollowTripsOnTheThirdSample) {
  for (const double sign : {1.0, -1.0}) {
    const double at_rad = sign * 2.0 * kRadPerDeg;  // both hubs
    Facts facts;
    facts.counters.angle_rad = {at_rad, at_rad, at_rad, at_rad};
    facts.reference_hub_rad = {sign * 22.1 * kRadPerDeg, at_rad};
    Expect(TripCause::kFollowingError1, 3, facts, 20.1 * kRadPerDeg, 20.0 * kRadPerDeg, 1);
    facts.reference_hub_rad = {at_rad, sign * 37.1 * kRadPerDeg};
    Expect(TripCause::kFollowingError2, 3, facts, 35.1 * kRadPerDeg, 35.0 * kRadPerDeg, 2);
    facts.reference_hub_rad = {sign * 21.9 * kRadPerDeg, sign * 36.9 * kRadPerDeg};
    for (int k = 0; k < 5; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  }
}

TEST_F(FaultDetectionTest, WithReducedLimitsTheFollowingErrorHasTheirShareOfTheAngle) {
  Facts facts;
  facts.reference_hub_rad = {10.1 * kRadPerDeg, 17.4 * kRadPerDeg};  // half of 20 and 35
  LoopFacts reduced = facts.Now();
  reduced.reduced = true;
  for (int k = 0; k < 2; ++k) EXPECT_EQ(monitor_.Judge(reduced).faults, 0u);
  EXPECT_EQ(monitor_.Judge(reduced).faults, CauseBit(TripCause::kFollowingError1));
}

// The samples in a row are counted with 8 bits.
TEST_F(FaultDetectionTest, AFaultThatLastsIsRaisedInEverySample) {
  Facts facts;
  facts.reference_hub_rad = {22.1 * kRadPerDeg, 0.0};
  for (int k = 1; k < 1'000; ++k) {
    const TripCauses expected = k < 3 ? 0U : CauseBit(TripCause::kFollowingError1);
    ASSERT_EQ(monitor_.Judge(facts.Now()).faults, expected) << "sample " << k;
  }
}

TEST_F(FaultDetectionTest, HubRatesTripOnTheSecondSample) {
  Facts facts;
  facts.estimate.x(6) = -8.1;
  Expect(TripCause::kHubRate1, 2, facts, 8.1, 8.0, 1);
  facts = {};
  facts.estimate.x(7) = 10.1;
  Expect(TripCause::kHubRate2, 2, facts, 10.1, 10.0, 2);
}

TEST_F(FaultDetectionTest, AHubRateInEverySecondSampleDoesNotTrip) {
  Facts fast;
  fast.estimate.x(6) = 9.0;
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(monitor_.Judge(fast.Now()).faults, 0u);
    EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u);
  }
}

TEST_F(FaultDetectionTest, BendingStrainTripsInTheSameSample) {
  Facts facts;
  facts.modes.root_strain = {-1.95e-3, 0.0};
  Expect(TripCause::kBendingStrain1, 1, facts, 1.95e-3, 1.9e-3, 1);
  facts.modes.root_strain = {0.0, 1.95e-3};
  Expect(TripCause::kBendingStrain2, 1, facts, 1.95e-3, 1.9e-3, 2);
}

// Without a fit, but with gauges that are bent to the end of their range, beyond the limit.
TEST_F(FaultDetectionTest, GaugesAtTheEndOfTheirRangeTripInTheSameSample) {
  Facts facts;
  facts.modes.valid[1] = false;
  facts.modes.root_strain[1] = std::numeric_limits<double>::quiet_NaN();
  facts.modes.beyond_range[1] = 2.0e-3;
  const FaultDetection::Verdict verdict = monitor_.Judge(facts.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kBendingStrain2));
  EXPECT_EQ(verdict.value, 2.0e-3);
  EXPECT_EQ(verdict.limit, 1.9e-3);
  EXPECT_EQ(verdict.channel, 2);
  EXPECT_FALSE(verdict.may_damp) << "its bending is not measured";
  facts.modes.beyond_range[1] = 1.9e-3;  // no farther than the limit: that tells nothing
  monitor_.Reset();
  EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0U);
  EXPECT_EQ(monitor_.Judge(facts.Now()).faults, CauseBit(TripCause::kNoStrainReading2));
}

TEST_F(FaultDetectionTest, AnEncoderJumpTripsAtOnceAndNamesItsCounter) {
  Facts facts;
  facts.counters.jumped = 0b0100;
  const auto verdict = monitor_.Judge(facts.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kEncoderJump));
  EXPECT_EQ(verdict.channel, 3);
  EXPECT_DOUBLE_EQ(verdict.limit, 14.0);
}

// The second sample in a row that lacks a reading: of each counter, by itself.
TEST_F(FaultDetectionTest, TwoSamplesWithoutACounterTripAndOneDoesNot) {
  for (std::uint16_t i = 0; i < 4; ++i) {
    Expect(TripCause::kNoCounterReading, 2, WithoutCounter(i), 2.0, 2.0,
           static_cast<std::uint16_t>(i + 1));
  }
}

// Evidence: the gauges that are left, and how many it takes.
TEST_F(FaultDetectionTest, TwoSamplesWithoutAFitTripAndOneDoesNot) {
  Expect(TripCause::kNoStrainReading1, 2, Unfitted(0, 2), 2.0, 3.0, 1);
  Expect(TripCause::kNoStrainReading2, 2, Unfitted(1, 0), 0.0, 3.0, 2);
}

TEST_F(FaultDetectionTest, EverySecondSampleWithoutAReadingDoesNotTrip) {
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(monitor_.Judge(Unfitted(0, 0).Now()).faults, 0u);
    EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u);
    EXPECT_EQ(monitor_.Judge(WithoutCounter(1).Now()).faults, 0u);
    EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u);
  }
}

// Sensors that fail in turn: none misses two samples, and yet the observer has no complete sample.
TEST_F(FaultDetectionTest, TwoSensorsThatFailInTurnTrip) {
  EXPECT_EQ(monitor_.Judge(Unfitted(0, 0).Now()).faults, 0u);
  EXPECT_EQ(monitor_.Judge(WithoutCounter(3).Now()).faults, CauseBit(TripCause::kNoCounterReading));
  EXPECT_EQ(monitor_.Judge(Unfitted(1, 0).Now()).faults, CauseBit(TripCause::kNoStrainReading2));
  EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u);
}

// The model stands for one missing reading: its angle and its bending have the limits of a reading.
TEST_F(FaultDetectionTest, AMissingReadingIsJudgedByTheModelForOneSample) {
  Facts angle = WithoutCounter(1);
  angle.estimate.x(1) = -90.1 * kRadPerDeg;
  EXPECT_EQ(monitor_.Judge(angle.Now()).faults, CauseBit(TripCause::kSoftLimit2));
  monitor_.Reset();
  Facts bent = Unfitted(1, 0);
  bent.model_root_strain = {0.0, -1.95e-3};
  const auto verdict = monitor_.Judge(bent.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kBendingStrain2));
  EXPECT_DOUBLE_EQ(verdict.value, 1.95e-3);
  EXPECT_FALSE(verdict.may_damp) << "the bending is not measured";
  bent.model_root_strain = {1.95e-3, 0.0};  // of link 1 there is a reading
  monitor_.Reset();
  EXPECT_EQ(monitor_.Judge(bent.Now()).faults, 0u);
}

// Symptom: an arm with much friction was at rest with a torque, which the estimate saw as bending
// beyond the limit; a single lost frame tripped.
TEST_F(FaultDetectionTest, BendingThatIsMissingIsTheLastReadingAndWhatTheModelBentSince) {
  for (std::size_t link = 0; link < 2; ++link) {
    SCOPED_TRACE(link);
    monitor_.Reset();
    Facts read;
    read.modes.root_strain[link] = 1e-4;
    read.model_root_strain[link] = 2.5e-3;
    EXPECT_EQ(monitor_.Judge(read.Now()).faults, 0u);
    Facts lost = Unfitted(link, 0);
    lost.model_root_strain[link] = 2.5e-3 + 1.79e-3;
    EXPECT_EQ(monitor_.Judge(lost.Now()).faults, 0u);
    EXPECT_EQ(monitor_.Judge(read.Now()).faults, 0u);
    lost.model_root_strain[link] = 2.5e-3 + 1.81e-3;  // 1.91e-3, the limit being 1.9e-3
    const auto verdict = monitor_.Judge(lost.Now());
    EXPECT_EQ(verdict.faults, CauseBit(static_cast<TripCause>(
                                  static_cast<std::size_t>(TripCause::kBendingStrain1) + link)));
    EXPECT_NEAR(verdict.value, 1.91e-3, 1e-12);
    monitor_.Reset();
    lost.model_root_strain[link] = 2e-3;  // 2.4e-3 less before
    EXPECT_NE(monitor_.Judge(lost.Now()).faults, 0u) << "nothing is kept over a reset";
    lost.model_root_strain[link] = 1.8e-3;
    monitor_.Reset();
    EXPECT_EQ(monitor_.Judge(lost.Now()).faults, 0u);
  }
}

// A NaN in any monitored quantity is a fault in that sample, whatever it came from.
TEST_F(FaultDetectionTest, NoLimitIsPassedByNaN) {
  const auto trips = [this](const auto& change, int ticks = 1) {
    monitor_.Reset();
    TripCauses faults = 0;
    for (int k = 0; k < ticks; ++k) {
      Facts facts;
      change(&facts);
      const auto verdict = monitor_.Judge(facts.Now());
      EXPECT_FALSE(verdict.may_damp && Damped(verdict.faults, true));
      faults = verdict.faults;
    }
    return faults;
  };
  EXPECT_NE(trips([](Facts* f) { f->counters.angle_rad[0] = kNan; }), 0u);
  EXPECT_NE(trips([](Facts* f) { f->counters.angle_rad[1] = kNan; }), 0u);
  EXPECT_NE(trips([](Facts* f) { f->modes.root_strain[0] = kNan; }), 0u);
  EXPECT_NE(trips([](Facts* f) { f->modes.root_strain[1] = kNan; }), 0u);
  EXPECT_NE(trips([](Facts* f) { f->estimate.x(6) = kNan; }), 0u);
  EXPECT_NE(trips([](Facts* f) { f->frame_age_s = kNan; }), 0u);
  const int ticks = config_.estimator.fault_ticks;
  for (std::size_t joint = 0; joint < 2; ++joint) {
    EXPECT_NE(trips([joint](Facts* f) { f->torque_nm[joint] = kNan; }, ticks), 0u) << joint;
    EXPECT_NE(trips([joint](Facts* f) { f->estimate.innovation[joint] = kNan; }, ticks), 0u);
    EXPECT_NE(trips([joint](Facts* f) { f->counters.angle_rad[2 + joint] = kNan; }, ticks), 0u);
  }
}

TEST_F(FaultDetectionTest, AnEncoderThatTheRigLacksDoesNotTrip) {
  SensorConfig without_rotors = config_.sensors;
  std::erase_if(without_rotors.encoder, [](const EncoderConfig& e) { return e.counter > 1; });
  FaultDetection hubs_only(config_.safety, config_.estimator, kPeriod_s, without_rotors,
                           kGaugesNeeded, {761.59, 497.96});
  Facts facts;
  facts.counters.good = 0b0011;
  facts.counters.missing_ticks = {0, 0, 500, 500};
  for (int k = 0; k < 5; ++k) EXPECT_EQ(hubs_only.Judge(facts.Now()).faults, 0u);
}

// 0.1 rad beyond the torsion of the joint spring by the torque.
TEST_F(FaultDetectionTest, HubAgainstRotorTripsBeyondTheTorsionByTheTorque) {
  Facts facts;
  facts.counters.angle_rad = {0.2, 0.0, 0.2 + 0.11, 0.0};
  Expect(TripCause::kHubAgainstRotor, 3, facts, 0.2 + 0.11 - 0.2, 0.1, 1);
  facts.counters.angle_rad = {0.0, 0.1, 0.0, 0.0};
  EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  // 761.59 N m twist joint 1 by one radian, so this is no fault.
  facts = {};
  facts.torque_nm = {761.59, 0.0};
  facts.counters.angle_rad = {0.0, 0.0, 1.0, 0.0};
  for (int k = 0; k < 5; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  facts.torque_nm = {-761.59, 0.0};
  for (int k = 0; k < 3; ++k) monitor_.Judge(facts.Now());
  EXPECT_EQ(monitor_.Judge(facts.Now()).faults, CauseBit(TripCause::kHubAgainstRotor));
}

TEST_F(FaultDetectionTest, HubAgainstRotorIsNotJudgedWithoutBothReadings) {
  Facts facts;
  facts.counters.angle_rad = {0.0, 0.0, 0.5, 0.0};
  facts.counters.good = 0b1011;
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(monitor_.Judge(facts.Now()).faults & CauseBit(TripCause::kHubAgainstRotor), 0u);
  }
}

// With every second frame lost, a fault would never be named; and a lost one would hide a cause
// that is still present from a reset.
TEST_F(FaultDetectionTest, ASampleWithoutReadingsIsNoEvidenceThatAFaultHasGone) {
  Facts apart, outlier, lost = WithoutCounter(0), innovation;
  apart.counters.angle_rad = {0.0, 0.0, 0.5, 0.0};
  outlier.modes.outlier = 1;
  innovation.estimate.innovation[0] = 1.0;
  using enum TripCause;
  for (const auto& [cause, facts] : {std::pair{kHubAgainstRotor, apart},
                                     {kStrainOutOfFamily, outlier},
                                     {kEstimatorResidual, innovation}}) {
    SCOPED_TRACE(ToString(cause));
    monitor_.Reset();
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
      EXPECT_EQ(monitor_.Judge(lost.Now()).faults, 0u);
    }
    EXPECT_EQ(monitor_.Judge(facts.Now()).faults, CauseBit(cause)) << "the third that tells";
    EXPECT_EQ(monitor_.Judge(lost.Now()).faults, CauseBit(cause));
    EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u);
  }
}

TEST_F(FaultDetectionTest, StrainChannelsTripAfterThreeSamplesAndAreNamed) {
  Facts facts;
  facts.modes.stuck = 1u << 4;
  Expect(TripCause::kStrainStuck, 3, facts, 0.0, 1e-4, 5);
  facts = {};
  facts.modes.outlier = 1u << 0;
  facts.modes.worst_outlier = 7e-4;
  Expect(TripCause::kStrainOutOfFamily, 3, facts, 7e-4, 4e-4, 1);
}

// Garbage is now within the range, now at its end: no three samples in a row need be the same
// fault.
TEST_F(FaultDetectionTest, ASaturatedChannelIsOutOfFamilyToo) {
  Facts outlier, saturated;
  outlier.modes.outlier = saturated.modes.saturated = 1u << 19;
  using enum TripCause;
  for (const Facts& facts : {outlier, saturated}) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  FaultDetection::Verdict verdict = monitor_.Judge(outlier.Now());
  EXPECT_EQ(verdict.faults, CauseBit(kStrainOutOfFamily));
  EXPECT_EQ(verdict.channel, 20);
  for (int k = 0; k < 3; ++k) verdict = monitor_.Judge(saturated.Now());
  EXPECT_EQ(verdict.faults, CauseBit(kStrainSaturated) | CauseBit(kStrainOutOfFamily));
  EXPECT_EQ(verdict.channel, 20);
}

// All gauges of a link repeat themselves while the model bends it: nothing else tells. At rest they
// may, and so may the gauges of a model that errs.
TEST_F(FaultDetectionTest, ALinkWhoseGaugesAllRepeatIsJudgedByTheModel) {
  Facts facts;
  facts.modes.repeated = {0, 0xFFC00};
  for (int k = 0; k < 10; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  facts.root_innovation = {9e-4, -1.2e-4};
  Expect(TripCause::kStrainStuck, 3, facts, 1.2e-4, 1e-4, 11);
  facts.modes.repeated = {0, 0};
  monitor_.Reset();
  for (int k = 0; k < 10; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
}

// The model bends the links of an arm whose hubs friction holds. A gauge then repeats itself by
// chance.
TEST_F(FaultDetectionTest, WhatTheModelWasOffByWhileTheGaugesLivedIsNoStuckGauge) {
  Facts facts;
  facts.root_innovation = {-5e-4, 3e-4};
  for (int k = 0; k < 5; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  facts.modes.repeated = {0x3FF, 0xFFC00};
  facts.root_innovation = {-4.01e-4, 3.99e-4};
  for (int k = 0; k < 5; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  facts.root_innovation = {-4.01e-4, 4.1e-4};
  for (int k = 0; k < 2; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  const FaultDetection::Verdict verdict = monitor_.Judge(facts.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kStrainStuck));
  EXPECT_DOUBLE_EQ(verdict.value, 4.1e-4 - 3e-4);
  EXPECT_EQ(verdict.channel, 11);
  monitor_.Reset();
  facts.root_innovation = {-4.5e-4, 3.5e-4};
  for (int k = 0; k < 2; ++k) EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  EXPECT_EQ(monitor_.Judge(facts.Now()).faults, CauseBit(TripCause::kStrainStuck))
      << "a reset forgets what they were off by";
}

TEST_F(FaultDetectionTest, AnIntermittentStrainFaultDoesNotTrip) {
  Facts bad;
  bad.modes.outlier = 1;
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(monitor_.Judge(bad.Now()).faults, 0u);
    EXPECT_EQ(monitor_.Judge(bad.Now()).faults, 0u);
    EXPECT_EQ(monitor_.Judge(Facts().Now()).faults, 0u);
  }
}

TEST_F(FaultDetectionTest, AStaleFrameTripsBeyondTwoPeriods) {
  Facts facts;
  facts.frame_age_s = 0.04;
  EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
  facts.frame_age_s = 0.041;
  Expect(TripCause::kStaleFrame, 1, facts, 0.041, 0.04, 0);
}

TEST_F(FaultDetectionTest, AStateThatIsNotFiniteTripsAtOnce) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (Eigen::Index i = 0; i < 12; ++i) {
      Facts facts;
      facts.estimate.x(i) = bad;
      monitor_.Reset();
      const auto faults = monitor_.Judge(facts.Now()).faults;
      EXPECT_TRUE((faults & CauseBit(TripCause::kStateNotFinite)) != 0) << i;
    }
  }
}

TEST_F(FaultDetectionTest, EstimatorResidualTripsAfterThreeSamplesAndNamesTheJoint) {
  Facts facts;
  facts.estimate.innovation[0] = -0.36;
  Expect(TripCause::kEstimatorResidual, 3, facts, 0.36, 0.35, 1);
  facts.estimate.innovation[1] = 0.4;
  Expect(TripCause::kEstimatorResidual, 3, facts, 0.4, 0.35, 2);
}

// Three causes in one sample: all are raised; the evidence is that of the lowest cause.
TEST_F(FaultDetectionTest, TheEvidenceIsThatOfTheLowestCause) {
  Facts facts;
  facts.frame_age_s = 0.1;
  facts.counters.jumped = 0b1000;
  facts.counters.angle_rad[1] = facts.counters.angle_rad[3] = 2.0;
  const auto verdict = monitor_.Judge(facts.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kSoftLimit2) | CauseBit(TripCause::kEncoderJump) |
                                CauseBit(TripCause::kStaleFrame));
  EXPECT_DOUBLE_EQ(verdict.value, 2.0);
  EXPECT_DOUBLE_EQ(verdict.limit, 90.0 * kRadPerDeg);
  EXPECT_EQ(verdict.channel, 2);
}

// Lower than one of those before it, and higher than another: the evidence stays.
TEST_F(FaultDetectionTest, TheEvidenceOfALowerCauseStays) {
  Facts facts;
  facts.frame_age_s = 0.1;
  facts.counters.jumped = 0b1000;
  facts.counters.angle_rad[2] = 0.5;
  FaultDetection::Verdict verdict{};
  for (int k = 0; k < 3; ++k) verdict = monitor_.Judge(facts.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kEncoderJump) |
                                CauseBit(TripCause::kHubAgainstRotor) |
                                CauseBit(TripCause::kStaleFrame));
  EXPECT_DOUBLE_EQ(verdict.limit, config_.estimator.max_joint_rate_rad_s);
  EXPECT_EQ(verdict.channel, 4);
}

TEST_F(FaultDetectionTest, ResetClearsTheCountsOfSamplesInARow) {
  Facts facts;
  facts.modes.stuck = 1;
  monitor_.Judge(facts.Now());
  monitor_.Judge(facts.Now());
  monitor_.Reset();
  EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0u);
}

// docs/safety.md, "Stop categories": 1.5 times the shipped limits, 8 and 10 rad/s, 1.9e-3.
TEST_F(FaultDetectionTest, DampingNeedsHubsAndBendingMeasuredAndNotFarBeyondTheirLimits) {
  const auto may_damp = [this](const auto& change) {
    Facts facts;
    change(&facts);
    return monitor_.Judge(facts.Now()).may_damp;
  };
  EXPECT_TRUE(may_damp([](Facts*) {}));
  EXPECT_TRUE(may_damp([](Facts* f) { f->estimate.x(6) = -11.9; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->estimate.x(6) = -12.1; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->estimate.x(7) = 15.1; }));
  EXPECT_TRUE(may_damp([](Facts* f) { f->modes.root_strain[0] = 2.8e-3; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->modes.root_strain[0] = -2.9e-3; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->modes.root_strain[1] = kNan; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->modes.valid[1] = false; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->counters.good = 0b1110; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->estimate.x(3) = kNan; }));
  EXPECT_FALSE(may_damp([](Facts* f) { f->mode = LoopMode::kOpenLoop; }));
}

}  // namespace
}  // namespace flexarm
