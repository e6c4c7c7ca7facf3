// The measured rate of a hub: what the encoder alone says, whatever the estimate.

#include <gtest/gtest.h>

#include <numbers>

#include "controller/step/fault_detection.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/step/healthy_facts.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

class HubRateTest : public testing::Test {
 protected:
  const RigConfig config_ = ShippedRig();
  FaultDetection monitor_{config_.safety,  config_.estimator, kPeriod_s,
                          config_.sensors, kGaugesNeeded,     {761.59, 497.96}};
};

// A hub that turns at rate_rad_s while the estimate says that it stands, as lagging gauges may make
// it: the number of samples until it trips, 0 if it does not within 50.
int SamplesUntilTrip(FaultDetection* detection, TripCause cause, std::size_t joint,
                     double rate_rad_s, double period_s) {
  Facts facts;
  for (int k = 0; k < 50; ++k) {
    facts.counters.angle_rad[joint] = facts.counters.angle_rad[joint + 2] =
        rate_rad_s * period_s * k;
    if ((detection->Judge(facts.Now()).faults & CauseBit(cause)) != 0) return k;
  }
  return 0;
}

// One count less than the encoder says: 2 pi / 2540 a period, 0.124 rad/s.
TEST_F(HubRateTest, AHubThatTurnsTooFastTripsWhateverTheEstimateSays) {
  const double count_rad_s = 2.0 * std::numbers::pi / 2540.0 / kPeriod_s;
  for (const double sign : {1.0, -1.0}) {
    monitor_.Reset();
    EXPECT_EQ(SamplesUntilTrip(&monitor_, TripCause::kHubRate1, 0, sign * (8.01 + count_rad_s),
                               kPeriod_s),
              2);
    monitor_.Reset();
    EXPECT_EQ(SamplesUntilTrip(&monitor_, TripCause::kHubRate2, 1, sign * (10.01 + count_rad_s),
                               kPeriod_s),
              2);
    monitor_.Reset();
    EXPECT_EQ(SamplesUntilTrip(&monitor_, TripCause::kHubRate1, 0, sign * (7.99 + count_rad_s),
                               kPeriod_s),
              0);
    monitor_.Reset();
    EXPECT_EQ(SamplesUntilTrip(&monitor_, TripCause::kHubRate2, 1, sign * (9.99 + count_rad_s),
                               kPeriod_s),
              0);
  }
}

// A count in 1 ms is 2.5 rad/s: the rate is taken over 20 ms, and twice the limit exceeds it after
// half of that and a count, (0.16 + 0.0025) / 16 s: in sample 11, and for the second time in 12.
TEST_F(HubRateTest, AMeasuredRateIsAMeanOver20Ms) {
  constexpr double kFast_s = 0.001;
  FaultDetection fast(config_.safety, config_.estimator, kFast_s, config_.sensors, kGaugesNeeded,
                      {761.59, 497.96});
  EXPECT_EQ(SamplesUntilTrip(&fast, TripCause::kHubRate1, 0, 2.0 * 8.0, kFast_s), 12);
}

TEST_F(HubRateTest, ASingleJumpOfAnEncoderIsNoRate) {
  Facts facts;
  for (int k = 0; k < 20; ++k) {
    facts.counters.angle_rad[0] = facts.counters.angle_rad[2] = k < 10 ? 0.0 : 0.2;
    EXPECT_EQ(monitor_.Judge(facts.Now()).faults & CauseBit(TripCause::kHubRate1), 0u) << k;
  }
}

// Only a hub that is not fast may be damped: what the rate of a single sample shows.
TEST_F(HubRateTest, AnArmThatBeginsElsewhereHasNotTurned) {
  Facts facts;
  facts.counters.angle_rad = {1.0, -1.0, 1.0, -1.0};
  EXPECT_TRUE(monitor_.Judge(facts.Now()).may_damp);
}

TEST_F(HubRateTest, AReadingThatIsMissingIsNoRate) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    monitor_.Reset();
    Facts facts;
    monitor_.Judge(facts.Now());
    facts.estimate.x(6 + static_cast<Eigen::Index>(joint)) = 1.2 * 10.0;
    EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0U) << "the first fast sample";
    facts = {};
    facts.counters.good &= ~(1U << joint);
    facts.counters.angle_rad[joint] = 1.0;  // whatever its driver has left there
    EXPECT_EQ(monitor_.Judge(facts.Now()).faults, 0U);
  }
}

// 7 rad/s; over one period it would be 14, and 12 is the most that is damped.
TEST_F(HubRateTest, AfterALostSampleTheRateIsThatOfTwoPeriods) {
  Facts facts, lost;
  lost.counters.good = 0b1110;
  monitor_.Judge(facts.Now());
  monitor_.Judge(lost.Now());
  facts.counters.angle_rad[0] = facts.counters.angle_rad[2] = 7.0 * 2.0 * kPeriod_s;
  EXPECT_TRUE(monitor_.Judge(facts.Now()).may_damp);
}

}  // namespace
}  // namespace flexarm
