// A value that is exactly at its limit, and what the evidence is of a sample that cannot tell.

#include <gtest/gtest.h>

#include <cstddef>

#include "controller/step/fault_detection.h"
#include "model/units.h"
#include "tests/controller/step/fault_detection_fixture.h"

namespace flexarm {
namespace {

class FaultLimitsTest : public FaultDetectionTest {
 protected:
  // Whether samples like this one, in a row, raise a fault.
  bool Trips(const Facts& facts) {
    monitor_.Reset();
    TripCauses faults = 0;
    for (int k = 0; k < 10; ++k) faults |= monitor_.Judge(facts.Now()).faults;
    return faults != 0;
  }
};

TEST_F(FaultLimitsTest, ALimitItselfIsNotBeyondIt) {
  for (const double sign : {1.0, -1.0}) {
    Facts facts;
    const double soft_rad = sign * 90.0 * kRadPerDeg;
    facts.counters.angle_rad = {soft_rad, soft_rad, soft_rad, soft_rad};
    EXPECT_FALSE(Trips(facts));
    facts = {};
    facts.estimate.x(6) = sign * config_.safety.hub_rate_rad_s[0];
    facts.estimate.x(7) = sign * config_.safety.hub_rate_rad_s[1];
    EXPECT_FALSE(Trips(facts));
    facts = {};
    facts.modes.root_strain = {sign * config_.safety.strain_limit[0],
                               sign * config_.safety.strain_limit[1]};
    EXPECT_FALSE(Trips(facts));
    facts = {};
    facts.reference_hub_rad = {sign * 20.0 * kRadPerDeg, sign * 35.0 * kRadPerDeg};
    EXPECT_FALSE(Trips(facts));
    facts = {};
    facts.counters.angle_rad = {0.0, 0.0, sign * config_.estimator.hub_rotor_limit_rad,
                                -sign * config_.estimator.hub_rotor_limit_rad};
    EXPECT_FALSE(Trips(facts));
    facts = {};
    facts.estimate.innovation[0] = sign * config_.estimator.innovation_limit_rad;
    facts.estimate.innovation[1] = sign * config_.estimator.innovation_limit_rad;
    EXPECT_FALSE(Trips(facts));
    facts = {};
    facts.modes.repeated = {0x3FF, 0xFFC00};
    facts.root_innovation = {sign * config_.estimator.strain_stuck_limit,
                             sign * config_.estimator.strain_stuck_limit};
    EXPECT_FALSE(Trips(facts));
  }
}

TEST_F(FaultLimitsTest, DampingEndsAtItsLimits) {
  const auto may_damp = [this](const auto& change) {
    Facts facts;
    change(&facts);
    monitor_.Reset();
    return monitor_.Judge(facts.Now()).may_damp;
  };
  const double most = FaultDetection::kDampedTo;
  EXPECT_FALSE(
      may_damp([&](Facts* f) { f->estimate.x(6) = most * config_.safety.hub_rate_rad_s[0]; }));
  EXPECT_FALSE(
      may_damp([&](Facts* f) { f->modes.root_strain[1] = most * config_.safety.strain_limit[1]; }));
}

// The soft limits are 90 degrees.
TEST_F(FaultLimitsTest, DampingEndsFarBeyondASoftLimit) {
  const auto may_damp = [this](std::size_t joint, double hub_deg, bool reduced, LoopMode mode) {
    Facts facts;
    facts.mode = mode;
    facts.counters.angle_rad[joint] = facts.counters.angle_rad[joint + 2] = hub_deg * kRadPerDeg;
    LoopFacts now = facts.Now();
    now.reduced = reduced;
    monitor_.Reset();
    return monitor_.Judge(now).may_damp;
  };
  const double reduced_deg = 90.0 * config_.safety.reduced_angle;
  for (const std::size_t joint : {0u, 1u}) {
    for (const double sign : {1.0, -1.0}) {
      EXPECT_TRUE(may_damp(joint, sign * 134.9, false, LoopMode::kFollow));
      EXPECT_FALSE(may_damp(joint, sign * 135.0, false, LoopMode::kFollow));
      EXPECT_TRUE(may_damp(joint, sign * (reduced_deg + 44.9), true, LoopMode::kFollow));
      EXPECT_FALSE(may_damp(joint, sign * (reduced_deg + 45.0), true, LoopMode::kFollow));
      EXPECT_TRUE(may_damp(joint, sign * 200.0, false, LoopMode::kRegulate))
          << "homing looks for the switches, which are beyond the soft limits";
    }
  }
}

// The pluck test compares no sensor with another, and has no soft limit to leave out.
TEST_F(FaultLimitsTest, ThePluckTestComparesNoSensors) {
  Facts facts;
  facts.mode = LoopMode::kOpenLoop;
  facts.counters.angle_rad = {0.0, 0.0, 0.5, 0.5};
  facts.modes.outlier = facts.modes.stuck = 1;
  facts.estimate.innovation[0] = 1.0;
  EXPECT_FALSE(Trips(facts));
  facts.modes.saturated = 1;
  EXPECT_TRUE(Trips(facts));
}

// The soft limits lie inside the switches, which homing looks for.
TEST_F(FaultLimitsTest, HomingLeavesOutTheSoftLimitsAlone) {
  Facts facts;
  facts.mode = LoopMode::kRegulate;
  facts.counters.angle_rad = {2.0, 2.0, 2.0, 2.0};
  EXPECT_FALSE(Trips(facts));
  facts.estimate.innovation[0] = 1.0;
  EXPECT_TRUE(Trips(facts));
}

// Still present, as the sample before has told; the present one names no gauge.
TEST_F(FaultLimitsTest, AFaultThatASampleCannotTellHasNoChannel) {
  Facts outlier;
  outlier.modes.outlier = 1U << 6U;
  FaultDetection::Verdict verdict{};
  for (int k = 0; k < 3; ++k) verdict = monitor_.Judge(outlier.Now());
  ASSERT_EQ(verdict.faults, CauseBit(TripCause::kStrainOutOfFamily));
  EXPECT_EQ(verdict.channel, 7);
  verdict = monitor_.Judge(WithoutCounter(0).Now());
  ASSERT_EQ(verdict.faults, CauseBit(TripCause::kStrainOutOfFamily));
  EXPECT_EQ(verdict.channel, 0);
}

// The worse one of two joints is the evidence.
TEST_F(FaultLimitsTest, TheEvidenceIsOfTheWorseJoint) {
  using enum TripCause;
  Facts facts;
  facts.counters.angle_rad = {0.0, 0.0, 0.2, -0.3};
  Expect(kHubAgainstRotor, 3, facts, 0.3, 0.1, 2);
  facts.counters.angle_rad = {0.0, 0.0, -0.3, 0.2};
  Expect(kHubAgainstRotor, 3, facts, 0.3, 0.1, 1);
  facts.counters.angle_rad = {0.0, 0.0, 0.3, 0.3};
  Expect(kHubAgainstRotor, 3, facts, 0.3, 0.1, 1);
  facts = {};
  facts.estimate.innovation[0] = facts.estimate.innovation[1] = 0.4;
  Expect(kEstimatorResidual, 3, facts, 0.4, 0.35, 1);
}

// In the second sample that lacks a reading the model stands for nothing any more.
TEST_F(FaultLimitsTest, WhatIsUnknownIsNotJudgedByTheModel) {
  using enum TripCause;
  Facts angle = WithoutCounter(1);
  angle.estimate.x(1) = 2.0;
  EXPECT_EQ(monitor_.Judge(angle.Now()).faults, CauseBit(kSoftLimit2));
  EXPECT_EQ(monitor_.Judge(angle.Now()).faults, CauseBit(kNoCounterReading));
  monitor_.Reset();
  Facts bent = Unfitted(0, 0);
  bent.model_root_strain = {3e-3, 0.0};
  EXPECT_EQ(monitor_.Judge(bent.Now()).faults, CauseBit(kBendingStrain1));
  EXPECT_EQ(monitor_.Judge(bent.Now()).faults, CauseBit(kNoStrainReading1));
}

// A joint is compared as long as its own two encoders are read, whatever the other one's do.
TEST_F(FaultLimitsTest, HubAgainstRotorNeedsBothReadingsOfItsJoint) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    for (std::size_t lost = 0; lost < 4; ++lost) {
      monitor_.Reset();
      Facts facts = WithoutCounter(lost);
      facts.counters.angle_rad[joint + 2] = 0.5;
      TripCauses faults = 0;
      for (int k = 0; k < 3; ++k) faults |= monitor_.Judge(facts.Now()).faults;
      EXPECT_EQ((faults & CauseBit(TripCause::kHubAgainstRotor)) != 0, lost % 2 != joint)
          << "joint " << joint + 1 << " without counter " << lost + 1;
    }
  }
}

TEST_F(FaultLimitsTest, AHubAgainstItsRotorThatCannotBeComparedHasNoChannel) {
  Facts apart;
  apart.counters.angle_rad = {0.0, 0.0, 0.5, 0.0};
  FaultDetection::Verdict verdict{};
  for (int k = 0; k < 3; ++k) verdict = monitor_.Judge(apart.Now());
  ASSERT_EQ(verdict.faults, CauseBit(TripCause::kHubAgainstRotor));
  apart.counters.good = 0;
  verdict = monitor_.Judge(apart.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kHubAgainstRotor));
  EXPECT_EQ(verdict.channel, 0);
  EXPECT_EQ(verdict.value, 0.0);
}

TEST_F(FaultLimitsTest, GaugesThatRepeatThemselvesAreNamedWithThoseOfEachLink) {
  using enum TripCause;
  Facts facts;
  facts.modes.repeated = {0x3FF, 0};
  facts.root_innovation = {-1.2e-4, 9e-4};
  Expect(kStrainStuck, 3, facts, 1.2e-4, 1e-4, 1);
  facts.modes.repeated = {1, 0};  // the only gauge
  Expect(kStrainStuck, 3, facts, 1.2e-4, 1e-4, 1);
  facts.modes.repeated = {0x3F8, 0xFFC00};  // the model tells both
  facts.root_innovation = {1.2e-4, 1.3e-4};
  Expect(kStrainStuck, 3, facts, 1.3e-4, 1e-4, 4);
  facts = {};
  facts.modes.stuck = 1U << 4U;
  facts.modes.repeated = {0, 0xFFC00};
  facts.root_innovation = {1e-3, 1.2e-4};
  Expect(kStrainStuck, 3, facts, 1.2e-4, 1e-4, 5);
  facts.modes.repeated = {};
  Expect(kStrainStuck, 3, facts, 0.0, 1e-4, 5);
}

// What has no measure has the evidence 0.
TEST_F(FaultLimitsTest, AJumpAndASaturatedGaugeHaveNoValue) {
  Facts facts;
  facts.counters.jumped = 1;
  Expect(TripCause::kEncoderJump, 1, facts, 0.0, config_.estimator.max_joint_rate_rad_s, 1);
  facts = {};
  facts.modes.saturated = 1U << 2U;
  facts.modes.worst_outlier = 5e-4;
  FaultDetection::Verdict verdict{};
  for (int k = 0; k < 3; ++k) verdict = monitor_.Judge(facts.Now());
  static_assert(TripCause::kStrainSaturated < TripCause::kStrainOutOfFamily);
  EXPECT_NE(verdict.faults & CauseBit(TripCause::kStrainSaturated), 0U);
  EXPECT_EQ(verdict.value, 0.0);
  EXPECT_EQ(verdict.limit, 0.0);
  EXPECT_EQ(verdict.channel, 3);
}

TEST_F(FaultLimitsTest, AStateThatIsNotFiniteIsThatAlone) {
  Facts facts;
  facts.estimate.x(3) = kNan;
  FaultDetection::Verdict verdict = monitor_.Judge(facts.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kStateNotFinite));
  EXPECT_EQ(verdict.value, 0.0);
  EXPECT_EQ(verdict.limit, 0.0);
  EXPECT_EQ(verdict.channel, 0);
  facts = {};
  facts.estimate.x(7) = kNan;  // the rate of hub 2
  monitor_.Reset();
  verdict = monitor_.Judge(facts.Now());
  EXPECT_EQ(verdict.faults, CauseBit(TripCause::kStateNotFinite));
  EXPECT_EQ(verdict.limit, config_.safety.hub_rate_rad_s[1]);
  EXPECT_EQ(verdict.channel, 2);
}

}  // namespace
}  // namespace flexarm
