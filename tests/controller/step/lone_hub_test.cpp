// A hub that no other encoder checks: what the model alone says of its reading.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/controller/step/fault_detection_fixture.h"

namespace flexarm {
namespace {

constexpr TripCauses kResidual = CauseBit(TripCause::kEstimatorResidual);

SensorConfig WithoutRotors(SensorConfig sensors, int joint) {
  std::erase_if(sensors.encoder, [joint](const EncoderConfig& encoder) {
    return encoder.counter == joint + 2 || (joint < 0 && encoder.counter > 1);
  });
  return sensors;
}

/// The shipped rig without the encoders of both rotors, or of one joint's: fault_ticks 3,
/// hub_rotor_limit_rad 0.1, innovation_limit_rad 0.35.
class LoneHubTest : public testing::Test {
 protected:
  FaultDetection Without(int joint, double period_s = kPeriod_s) const {
    return {config_.safety, config_.estimator, period_s, WithoutRotors(config_.sensors, joint),
            kGaugesNeeded,  {761.59, 497.96}};
  }

  /// Turns a hub by turn_rad a sample, three times, then repeats its reading.
  /// @returns the number of repeated samples at the trip, which names it; 0: no trip in 20
  int RepeatsUntilTrip(double turn_rad, double innovation_rad, double torque_nm,
                       std::size_t joint = 1) {
    Facts facts = Turn(turn_rad, torque_nm, joint);
    facts.estimate.innovation[joint] = innovation_rad;
    for (int k = 1; k <= 20; ++k) {
      const FaultDetection::Verdict verdict = hubs_only_.Judge(facts.Now());
      facts.estimate.innovation[joint] = 0.0;  // the estimate followed
      if (verdict.faults == 0) continue;
      EXPECT_EQ(verdict.faults, kResidual);
      EXPECT_DOUBLE_EQ(verdict.value, k * std::min(std::fabs(turn_rad), std::fabs(innovation_rad)));
      EXPECT_EQ(verdict.limit, 0.1);
      EXPECT_EQ(verdict.channel, joint + 1);
      return k;
    }
    return 0;
  }

  Facts Turn(double turn_rad, double torque_nm, std::size_t joint = 1) {
    hubs_only_.Reset();
    Facts facts;
    facts.counters.good = 0b0011;
    facts.torque_nm[joint] = torque_nm;
    for (int k = 0; k < 3; ++k) {
      facts.counters.angle_rad[joint] += turn_rad;
      EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
    }
    return facts;
  }

  const RigConfig config_ = ShippedRig();
  FaultDetection hubs_only_ = Without(-1);
};

TEST_F(LoneHubTest, OneInnovationBeyondItsLimitTripsAtOnce) {
  for (const double sign : {1.0, -1.0}) {
    for (const std::size_t joint : {0UL, 1UL}) {
      hubs_only_.Reset();
      Facts facts;
      facts.counters.good = 0b0011;
      facts.estimate.innovation[joint] = sign * 0.349;
      EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
      facts.estimate.innovation[joint] = sign * 0.351;
      const FaultDetection::Verdict verdict = hubs_only_.Judge(facts.Now());
      EXPECT_EQ(verdict.faults, kResidual);
      EXPECT_EQ(verdict.value, 0.351);
      EXPECT_EQ(verdict.limit, 0.35);
      EXPECT_EQ(verdict.channel, joint + 1);
    }
  }
}

TEST_F(LoneHubTest, TheOtherJointHasItsThreeSamples) {
  for (const std::size_t joint : {0UL, 1UL}) {
    FaultDetection detection = Without(static_cast<int>(joint));
    Facts facts;
    facts.counters.good &= ~(1U << (joint + 2));
    facts.estimate.innovation[1 - joint] = 0.36;
    facts.estimate.innovation[joint] = 0.35;  // at its limit, not beyond
    for (int k = 0; k < 2; ++k) EXPECT_EQ(detection.Judge(facts.Now()).faults, 0u);
    EXPECT_EQ(detection.Judge(facts.Now()).faults, kResidual);
    detection.Reset();
    facts.estimate.innovation[joint] = 0.36;
    EXPECT_EQ(detection.Judge(facts.Now()).faults, kResidual);
  }
}

// Off by more than 0.1 rad, and repeated three times; within 80 ms, which are four samples.
TEST_F(LoneHubTest, AReadingThatStandsStillWhileTheHubTurnsTrips) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(RepeatsUntilTrip(sign * 0.15, sign * -0.15, 0.5), 3);
    EXPECT_EQ(RepeatsUntilTrip(sign * 0.05, sign * -0.05, 0.5), 3);
    EXPECT_EQ(RepeatsUntilTrip(sign * 0.034, sign * -0.034, -0.5), 3);
    EXPECT_EQ(RepeatsUntilTrip(sign * 0.033, sign * -0.033, -0.5), 4);
    EXPECT_EQ(RepeatsUntilTrip(sign * 0.0251, sign * -0.0251, 0.5), 4);
    EXPECT_EQ(RepeatsUntilTrip(sign * 0.0251, sign * -0.0251, 0.5, 0), 4);
  }
}

TEST_F(LoneHubTest, ASlowHubMayHaveComeToRest) {
  EXPECT_EQ(RepeatsUntilTrip(0.0249, -0.0249, 0.5), 0);
  EXPECT_EQ(RepeatsUntilTrip(0.03, -0.025, 0.5), 0) << "off by the limit, not more";
}

// 80 ms are eight samples at 100 Hz, and one at 10 Hz, where the third trips.
TEST_F(LoneHubTest, TheTimeDoesNotDependOnTheSamplingRate) {
  hubs_only_ = Without(-1, 0.01);
  EXPECT_EQ(RepeatsUntilTrip(0.0126, -0.0126, 0.5), 8);
  EXPECT_EQ(RepeatsUntilTrip(0.0124, -0.0124, 0.5), 0);
  hubs_only_ = Without(-1, 0.1);
  EXPECT_EQ(RepeatsUntilTrip(0.034, -0.034, 0.5), 3);
  EXPECT_EQ(RepeatsUntilTrip(0.033, -0.033, 0.5), 0);
}

TEST_F(LoneHubTest, AHubThatItsDriveStopsHasNoInnovation) {
  EXPECT_EQ(RepeatsUntilTrip(0.05, -0.001, 0.5), 0);
  EXPECT_EQ(RepeatsUntilTrip(0.05, -0.03, 0.5), 4) << "what the model says is less";
  EXPECT_EQ(RepeatsUntilTrip(0.03, -0.05, 0.5), 4) << "what it turned is less";
}

TEST_F(LoneHubTest, WithoutATorqueABrakeMayHoldIt) {
  EXPECT_EQ(RepeatsUntilTrip(0.05, -0.05, 0.0), 0);
  Facts facts = Turn(0.05, 0.0);
  facts.estimate.innovation[1] = -0.05;
  hubs_only_.Judge(facts.Now());
  facts.torque_nm[1] = 0.5;
  for (int k = 0; k < 10; ++k) EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
}

TEST_F(LoneHubTest, AHubThatMovesAgainIsForgiven) {
  Facts facts = Turn(0.05, 0.5);
  facts.estimate.innovation[1] = -0.05;
  for (int k = 0; k < 2; ++k) EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
  facts.estimate.innovation[1] = 0.0;
  facts.counters.angle_rad[1] += 0.001;
  for (int k = 0; k < 10; ++k) EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
}

TEST_F(LoneHubTest, AMissingReadingTellsNothing) {
  Facts facts = Turn(0.05, 0.5);
  facts.estimate.innovation[1] = -0.05;
  for (int k = 0; k < 2; ++k) EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
  facts.counters.good = 0b0001;
  EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
  facts.counters.good = 0b0011;
  EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, kResidual) << "the third";
}

TEST_F(LoneHubTest, ThePluckTestIsNotJudged) {
  Facts facts = Turn(0.05, 0.5);
  facts.mode = LoopMode::kOpenLoop;
  facts.estimate.innovation[1] = -0.36;
  for (int k = 0; k < 10; ++k) EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
}

TEST_F(LoneHubTest, ResetForgetsHowItTurned) {
  Facts facts = Turn(0.05, 0.5);
  facts.estimate.innovation[1] = -0.05;
  hubs_only_.Judge(facts.Now());
  hubs_only_.Reset();
  for (int k = 0; k < 10; ++k) EXPECT_EQ(hubs_only_.Judge(facts.Now()).faults, 0u);
}

TEST_F(LoneHubTest, WithARotorEncoderAHubMayStandStill) {
  FaultDetection both(config_.safety, config_.estimator, kPeriod_s, config_.sensors, kGaugesNeeded,
                      {761.59, 497.96});
  Facts facts;
  facts.torque_nm[1] = 0.5;
  for (int k = 0; k < 3; ++k) {
    facts.counters.angle_rad[1] += 0.05;
    facts.counters.angle_rad[3] += 0.05;
    EXPECT_EQ(both.Judge(facts.Now()).faults, 0u);
  }
  facts.estimate.innovation[1] = -0.05;
  for (int k = 0; k < 10; ++k) EXPECT_EQ(both.Judge(facts.Now()).faults, 0u);
}

}  // namespace
}  // namespace flexarm
