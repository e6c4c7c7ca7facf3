#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/controller/wired/hostile_rig.h"
#include "tests/controller/wired/supply_models.h"
#include "tests/support/campaign.h"

// The whole stack with drives whose DC link is fed through relay and charge pump, and which report
// it: each channel is tested alone when the arm is armed.

namespace flexarm {
namespace {

using enum SafetyState;

constexpr DriveVoltageTimes kTimes{.rise_ms = 400.0, .fall_ms = 100.0};

class PowerPathOfDrives : public HostileBus, public testing::WithParamInterface<DriveSupplyModel> {
 protected:
  void Start() { StartIdle(ModbusTransport::kTcp, GetParam(), kTimes); }

  bool On() {
    return rig_->world->node(CanopenRole::kDrive1).state() == DriveState::kOperationEnabled &&
           rig_->world->node(CanopenRole::kDrive2).state() == DriveState::kOperationEnabled;
  }

  void ExpectTripped(LineTrouble trouble) {
    EXPECT_TRUE(rig_->RunUntil(2000 * kMs, [this] { return rig_->tripped(); }));
    EXPECT_EQ(rig_->permit().cause, TripCause::kSafetyLines) << ToString(rig_->permit().cause);
    EXPECT_EQ(rig_->permit().evidence.channel, static_cast<std::uint32_t>(trouble));
    EXPECT_FALSE(rig_->world->lines.relay);
    EXPECT_FALSE(On());
  }

  // States in the order in which they were entered, from the records of the safety task.
  std::vector<SafetyState> Entered() {
    std::vector<SafetyState> states;
    SafetyRecord record{};
    while (rig_->stack->safety_records().Pop(&record)) {
      if (record.after.state != record.before.state) states.push_back(record.after.state);
      EXPECT_EQ(NextSafetyState(record.before, record.facts),
                (SafetyDecision{record.after, record.refusal}))
          << "the record replays";
    }
    return states;
  }
};

INSTANTIATE_TEST_SUITE_P(Supply, PowerPathOfDrives, kSupplyModels, NameOfSupply);

TEST_P(PowerPathOfDrives, CampaignOfArmsAndDisarmsTestsEachChannelAndNeverTrips) {
  ASSERT_NO_FATAL_FAILURE(Start());
  Entered();
  const long cycles = CampaignCases(3, 50);
  for (long cycle = 0; cycle < cycles; ++cycle) {
    SCOPED_TRACE(cycle);
    const std::int64_t asked_ns = rig_->executor.now_ns();
    ASSERT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
    // Two rise times with a report each, and the charge with a report.
    EXPECT_LE(rig_->executor.now_ns() - asked_ns, 1200 * kMs);
    EXPECT_GE(rig_->executor.now_ns() - asked_ns, 1100 * kMs);
    EXPECT_EQ(Entered(), (std::vector{kTestingPump, kTestingRelay, kTestingPower, kArmed}));
    if (cycle == 1) {
      ASSERT_EQ(rig_->Ask(RequestKind::kRun), Refusal::kNone);
      rig_->RunFor(100 * kMs);
      ASSERT_EQ(rig_->permit().state, kRunning) << ToString(rig_->permit().cause);
      rig_->Stop();
    }
    ASSERT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return On(); }));
    rig_->Disarm();
    rig_->RunFor(1000 * kMs);
    ASSERT_TRUE(rig_->RunUntil(2000 * kMs, [this] { return rig_->last.output.at_rest != 0; }));
    rig_->RunFor(20 * kMs);
    Entered();
  }
  EXPECT_EQ(rig_->Failed(), 0U);
}

TEST_P(PowerPathOfDrives, AWeldedRelayIsFoundBeforeTheArmIsArmed) {
  ASSERT_NO_FATAL_FAILURE(Start());
  rig_->world->lines.welded = true;
  EXPECT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kUnhealthy);
  ExpectTripped(LineTrouble::kRelayStuckClosed);
}

TEST_P(PowerPathOfDrives, AStuckChargePumpIsFoundBeforeTheArmIsArmed) {
  ASSERT_NO_FATAL_FAILURE(Start());
  rig_->world->lines.pump_stuck = true;
  EXPECT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kUnhealthy);
  ExpectTripped(LineTrouble::kPumpStuckOn);
  rig_->world->lines.pump_stuck = false;
  rig_->RunFor(200 * kMs);
  rig_->PressButton();
  ExpectReset();
  EXPECT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
}

TEST_P(PowerPathOfDrives, ASupplyThatDoesNotComeIsNamed) {
  ASSERT_NO_FATAL_FAILURE(Start());
  rig_->world->supply_fails = true;
  EXPECT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kUnhealthy);
  ExpectTripped(LineTrouble::kVoltageMissing);
}

// Relay and charge pump are stuck at a trip of another cause: it cannot be reset.
TEST_P(PowerPathOfDrives, VoltageThatStaysOnKeepsATripFromBeingReset) {
  ASSERT_NO_FATAL_FAILURE(Start());
  ASSERT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
  ASSERT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return On(); }));
  rig_->world->lines.welded = rig_->world->lines.pump_stuck = true;
  rig_->world->lines.levels &= ~LineBit(Line::kEmergencyStop);
  ASSERT_TRUE(rig_->RunUntil(20 * kMs, [this] { return rig_->tripped(); }));
  EXPECT_EQ(rig_->permit().cause, TripCause::kEmergencyStop);
  rig_->world->lines.levels = kHealthyLevels;
  rig_->RunFor(1000 * kMs);
  rig_->PressButton();
  EXPECT_EQ(rig_->Ask(RequestKind::kReset), Refusal::kCauseRemains);
  EXPECT_EQ(rig_->present, CauseBit(TripCause::kSafetyLines)) << CauseNames(rig_->present);
  rig_->world->lines.welded = rig_->world->lines.pump_stuck = false;
  rig_->RunFor(200 * kMs);
  ExpectReset();
}

// An exchange that fails during a test proves nothing and costs time only.
TEST_P(PowerPathOfDrives, AMissedAnswerInATestIsNoFailure) {
  ASSERT_NO_FATAL_FAILURE(Start());
  rig_->stack->requests().Push(
      {.kind = RequestKind::kArm, .number = 900, .not_before_ns = INT64_MIN, .run = {}});
  ASSERT_TRUE(rig_->RunUntil(50 * kMs, [this] { return rig_->permit().state == kTestingPump; }));
  // The first report after the rise time is the one that fails.
  const std::int64_t settled_ns = rig_->executor.now_ns() + 400 * kMs;
  rig_->RunFor((settled_ns + 19 * kMs) / (20 * kMs) * (20 * kMs) - rig_->executor.now_ns() -
               10 * kMs);
  rig_->world->node(CanopenRole::kDrive1).Misbehave({.answers_no_sync = true});
  rig_->RunFor(20 * kMs);
  rig_->world->node(CanopenRole::kDrive1).Misbehave({});
  EXPECT_EQ(rig_->permit().state, kTestingPump);
  EXPECT_EQ(rig_->Failed(), 1U);
  EXPECT_TRUE(rig_->RunUntil(1500 * kMs, [this] { return rig_->permit().state == kArmed; }))
      << ToString(rig_->permit().state);
}

}  // namespace
}  // namespace flexarm
