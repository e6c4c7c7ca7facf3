// The limit switch that a homing run searches for.

#include <gtest/gtest.h>

#include "controller/safety/safety_monitor.h"
#include "tests/controller/safety/monitored_arm.h"

namespace flexarm {
namespace {

using enum SafetyState;

// A homing run searches for one limit switch, which may open during the run, for a limited time.
class HomingContact : public testing::Test {
 protected:
  SafetyInputs OnSwitch(std::int64_t after_ms = 0) const {
    SafetyInputs in = Fine();
    in.due_ns += after_ms * kMs;
    in.control_alive_ns = in.control.due_ns = in.due_ns - 20 * kMs;
    in.drive_alive_ns = in.drive.due_ns = in.due_ns - kMs;
    in.may_open = LineBit(Line::kLimit2High);
    in.levels &= ~LineBit(Line::kLimit2High);
    return in;
  }
  SafetyInputs OffSwitch(std::int64_t after_ms = 0) const {
    SafetyInputs in = OnSwitch(after_ms);
    in.levels = kHealthyLevels;
    return in;
  }

  SafetyMonitor monitor_{kLimits};
};

TEST_F(HomingContact, TheSwitchSearchedForDoesNotTripAtOnce) {
  monitor_.Judge(OffSwitch());
  EXPECT_EQ(monitor_.Judge(OnSwitch(1)).present, 0u);
  EXPECT_EQ(monitor_.Judge(OnSwitch(500)).present, 0u);
}

TEST_F(HomingContact, EachLimitSwitchMayBeTheOneSearchedFor) {
  for (const Line line :
       {Line::kLimit1Low, Line::kLimit1High, Line::kLimit2Low, Line::kLimit2High}) {
    SafetyMonitor monitor(kLimits);
    monitor.Judge(OffSwitch());
    SafetyInputs in = OnSwitch(1);
    in.may_open = LineBit(line);
    in.levels = kHealthyLevels & ~LineBit(line);
    EXPECT_EQ(monitor.Judge(in).present, 0u) << static_cast<int>(line);
  }
}

TEST_F(HomingContact, StayingOnItForTooLongTrips) {
  monitor_.Judge(OffSwitch());
  EXPECT_EQ(monitor_.Judge(OnSwitch(501)).present, CauseBit(TripCause::kLimitSwitch2High));
}

TEST_F(HomingContact, TheTimeGoesOnWhenTheSwitchHasClosedBetween) {
  monitor_.Judge(OffSwitch());
  EXPECT_EQ(monitor_.Judge(OnSwitch(300)).present, 0u);
  EXPECT_EQ(monitor_.Judge(OffSwitch(500)).present, 0u);
  EXPECT_EQ(monitor_.Judge(OnSwitch(700)).present, 0u) << "0.5 s in all";
  EXPECT_EQ(monitor_.Judge(OffSwitch(701)).present, 0u) << "off the switch";
  EXPECT_EQ(monitor_.Judge(OnSwitch(702)).present, CauseBit(TripCause::kLimitSwitch2High));
}

TEST_F(HomingContact, TheTimeBeginsAgainWithTheNextRun) {
  monitor_.Judge(OffSwitch());
  monitor_.Judge(OnSwitch(500));
  SafetyInputs armed = OffSwitch(501);
  armed.state = kArmed;
  monitor_.Judge(armed);
  EXPECT_EQ(monitor_.Judge(OnSwitch(1001)).present, 0u) << "the whole 0.5 s again";
}

TEST_F(HomingContact, EveryOtherSwitchTrips) {
  monitor_.Judge(OffSwitch());
  SafetyInputs in = OnSwitch(1);
  in.levels &= ~LineBit(Line::kLimit2Low);
  EXPECT_EQ(monitor_.Judge(in).present, CauseBit(TripCause::kLimitSwitch2Low));
}

TEST_F(HomingContact, TheEmergencyStopAlwaysTrips) {
  monitor_.Judge(OffSwitch());
  SafetyInputs in = OnSwitch(1);
  in.may_open |= LineBit(Line::kEmergencyStop);
  in.levels &= ~LineBit(Line::kEmergencyStop);
  EXPECT_EQ(monitor_.Judge(in).present, CauseBit(TripCause::kEmergencyStop));
}

TEST_F(HomingContact, TheSwitchMayOpenOnlyWhileRunning) {
  for (const SafetyState state : {kIdle, kArmed, kStopping, kTripped}) {
    SafetyInputs in = OnSwitch();
    in.state = state;
    EXPECT_EQ(monitor_.Judge(in).present, CauseBit(TripCause::kLimitSwitch2High))
        << ToString(state);
  }
}

}  // namespace
}  // namespace flexarm
