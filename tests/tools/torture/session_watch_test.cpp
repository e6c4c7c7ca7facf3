// A session that keeps every rule, and one that breaks each of them: the watch names it.

#include "tools/torture/session_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using enum SafetyState;

class SessionWatchTest : public testing::Test {
 public:
  WatchSample sample{
      .status = {kIdle, TripCause::kNone},
      .told = {.relay_closed = false, .pump_level = false},
      .torque_nm = {},
      .arm_ns = 0,
      .truth = {.hub_angle_rad = {}, .tip_m = {}, .tip_deflection_m = {}, .known = true},
      .strain_share = 0.0};

  void Look(int ms = 1, bool arm_stands = false) {
    for (int i = 0; i < ms; ++i) {
      now_ns_ += kMs;
      if (!arm_stands) sample.arm_ns = now_ns_;
      watch.Look(now_ns_, sample);
    }
  }
  // Turns a hub for some milliseconds: hub 2 of the shipped rig has a limit of 10 rad/s.
  void Turn(std::size_t joint, double rate_rad_s, int ms) {
    for (int i = 0; i < ms; ++i) {
      sample.truth.hub_angle_rad[joint] += rate_rad_s * 1e-3;
      Look();
    }
  }
  void Become(SafetyState state, TripCause cause = TripCause::kNone) {
    sample.status = {state, cause};
    sample.told.relay_closed = DrivesEnabled(state);
    Look();
  }
  // Armed and Running with a torque, by the commands for it.
  void RunWithTorque() {
    Look(10);
    watch.Allow("arm");
    Become(kArmed);
    watch.Allow("run");
    Become(kRunning);
    sample.torque_nm = {5.0, 1.0};
    Look(30);
  }
  void ExpectBroken(const std::string& rule) {
    ASSERT_FALSE(watch.violations().empty()) << rule;
    EXPECT_EQ(watch.violations().front().rule, rule);
  }

  const RigConfig config = ShippedRig();
  SessionWatch watch{
      config,
      {.torque_after_ns = 2 * kMs,
       .most = {.torque_share = 1.0, .angle_share = 1.3, .rate_share = 2.0, .strain_share = 1.3}}};

 private:
  std::int64_t now_ns_ = 0;
};

TEST_F(SessionWatchTest, ASessionInOrderBreaksNothing) {
  RunWithTorque();
  sample.torque_nm = {};
  Become(kTripped, TripCause::kEmergencyStop);
  Look(20);
  watch.ButtonPressed();
  watch.Allow("reset");
  Become(kIdle);
  EXPECT_TRUE(watch.violations().empty()) << watch.violations().front().what;
  ASSERT_TRUE(watch.first_cause());
  EXPECT_EQ(watch.first_cause()->cause, TripCause::kEmergencyStop);
}

TEST_F(SessionWatchTest, TorqueMayStayForTheTimeOfTheRuleAndNoLonger) {
  RunWithTorque();
  Become(kTripped, TripCause::kHubRate1);
  Look(2);
  EXPECT_TRUE(watch.violations().empty());
  Look();
  ExpectBroken("torque-only-while-permitted");
}

// What counts is the time of the arm, whose thread may hang: it has not moved yet.
TEST_F(SessionWatchTest, TheTorqueOfAnArmThatStandsStillInTimeIsThatOfItsOwnTime) {
  RunWithTorque();
  sample.status = {kTripped, TripCause::kStaleFrame};
  sample.told.relay_closed = false;
  Look(50, true);
  EXPECT_TRUE(watch.violations().empty());
}

struct Breach {
  const char* rule;
  void (*breaks)(SessionWatchTest* test);
};

class EachRule : public SessionWatchTest, public testing::WithParamInterface<Breach> {};

TEST_P(EachRule, IsNamedWhenItIsBroken) {
  RunWithTorque();
  GetParam().breaks(this);
  Look();
  ExpectBroken(GetParam().rule);
}

void Trip(SessionWatchTest* test) {
  test->sample.torque_nm = {};
  test->Become(kTripped, TripCause::kHubRate1);
}

// The shipped rig: 30 and 6 N m, slew 10 and 3 N m in a period of 20 ms, soft limits at 90 degrees.
INSTANTIATE_TEST_SUITE_P(
    Rules, EachRule,
    testing::Values(
        Breach{"torque-limit",
               [](SessionWatchTest* session) { session->sample.torque_nm[1] = 6.1; }},
        Breach{"slew-limit",
               [](SessionWatchTest* session) { session->sample.torque_nm[1] = -2.1; }},
        Breach{"finite-torque",
               [](SessionWatchTest* session) {
                 session->sample.torque_nm[0] = std::numeric_limits<double>::quiet_NaN();
               }},
        Breach{"envelope", [](SessionWatchTest* session) { session->sample.strain_share = 1.4; }},
        Breach{"envelope",
               [](SessionWatchTest* session) {
                 session->sample.truth.hub_angle_rad[1] = 118.0 * kRadPerDeg;
               }},
        Breach{"finite-arm",
               [](SessionWatchTest* session) {
                 session->sample.truth.hub_angle_rad[0] = std::numeric_limits<double>::quiet_NaN();
               }},
        Breach{"envelope", [](SessionWatchTest* session) { session->Turn(1, 2.1 * 10.0, 21); }},
        Breach{"trip-opens-the-relay",
               [](SessionWatchTest* session) {
                 Trip(session);
                 session->sample.told.relay_closed = true;
               }},
        Breach{"latched",
               [](SessionWatchTest* session) {
                 session->Become(kFaultStopping, TripCause::kHubRate1);
                 session->Become(kArmed);
               }},
        Breach{"latched",
               [](SessionWatchTest* session) {
                 Trip(session);
                 session->watch.Allow("reset");
                 session->Become(kIdle);
               }},
        Breach{"latched",
               [](SessionWatchTest* session) {
                 Trip(session);
                 session->watch.ButtonPressed();
                 session->Become(kIdle);
               }}),
    [](const auto& shown) {
      std::string name = shown.param.rule + std::to_string(shown.index);
      std::erase(name, '-');
      return name;
    });

// As the loop sees it: a hub springs back faster than its limit for a moment, also just after the
// arm's thread was late.
TEST_F(SessionWatchTest, ARateIsTakenOverAWholePeriod) {
  RunWithTorque();
  Turn(1, 3.0 * 10.0, 10);
  Look(20, true);
  sample.arm_ns += 20 * kMs;
  Turn(1, 3.0 * 10.0, 10);
  EXPECT_TRUE(watch.violations().empty()) << watch.violations().front().what;
}

// 10 N m for joint 1 and each command: 40 ms are two of them.
TEST_F(SessionWatchTest, AnArmThatCatchesUpMayTakeACommandAPeriod) {
  RunWithTorque();
  Look(39, true);
  sample.torque_nm[0] = -15.0;  // from 5
  Look();
  EXPECT_TRUE(watch.violations().empty()) << watch.violations().front().what;
  Look(39, true);
  sample.torque_nm[0] = 20.5;  // more than two commands from 0, too
  Look();
  ExpectBroken("slew-limit");
}

// The charge pump fails and comes back between two looks: from -6 to 0, and on to 9.
TEST_F(SessionWatchTest, ATorqueMayBeCutBetweenTwoLooks) {
  RunWithTorque();
  sample.torque_nm[0] = -5.0;
  Look(10);
  Look(1, true);
  sample.torque_nm[0] = 9.0;
  Look();
  EXPECT_TRUE(watch.violations().empty()) << watch.violations().front().what;
  sample.torque_nm[0] = -5.0;
  Look();
  ExpectBroken("slew-limit");
}

TEST_F(SessionWatchTest, ATorqueThatWasNotCutMayNotJump) {
  RunWithTorque();
  Look(1, true);
  sample.torque_nm[0] = -10.5;  // from 5, and more than 10 from 0
  Look();
  ExpectBroken("slew-limit");
}

TEST_F(SessionWatchTest, AnAngleThatNothingMeasuresIsNotJudged) {
  SessionWatch hidden(
      config,
      {.torque_after_ns = 2 * kMs,
       .most = {.torque_share = 1.0, .angle_share = 1.3, .rate_share = 2.0, .strain_share = 1.3},
       .angle_hidden = {false, true}});
  hidden.Allow("arm");
  hidden.Allow("run");
  sample.told.relay_closed = true;
  sample.status = {kArmed, TripCause::kNone};
  hidden.Look(kMs, sample);
  sample.status = {kRunning, TripCause::kNone};
  sample.torque_nm = {5.0, 1.0};
  sample.truth.hub_angle_rad = {0.0, 118.0 * kRadPerDeg};
  hidden.Look(2 * kMs, sample);
  EXPECT_TRUE(hidden.violations().empty()) << hidden.violations().front().what;
  sample.truth.hub_angle_rad = {118.0 * kRadPerDeg, 0.0};
  hidden.Look(3 * kMs, sample);
  ASSERT_FALSE(hidden.violations().empty());
  EXPECT_EQ(hidden.violations().front().rule, "envelope");
}

TEST_F(SessionWatchTest, NothingArmsOrRunsByItself) {
  Look(5);
  Become(kArmed);
  ExpectBroken("arms-by-itself");
}

// A command that has had its effect permits no second one.
TEST_F(SessionWatchTest, OneCommandPermitsOneChange) {
  RunWithTorque();
  sample.torque_nm = {};
  Become(kIdle);
  EXPECT_TRUE(watch.violations().empty());
  Become(kArmed);
  ExpectBroken("arms-by-itself");
}

TEST_F(SessionWatchTest, ARunNeedsACommand) {
  Look(5);
  watch.Allow("arm");
  Become(kArmed);
  Become(kRunning);
  ExpectBroken("runs-by-itself");
}

}  // namespace
}  // namespace flexarm
