#include <gtest/gtest.h>

#include "tests/controller/wired/hostile_rig.h"

namespace flexarm {
namespace {

// Reaction at the simulated drives, over the phase of the event in the period of the buses, in
// steps of a millisecond: 0.9 ms until the next tick of safety, one more tick, whose sample must
// agree, and the frames on the wire: two controlwords and a SYNC at 1 Mbit/s take 0.3 ms. The
// simulated drives and this test look every millisecond. With the torque of the last exchange until
// the next, it would be 20 ms.
class StopReaction : public HostileBus, public testing::WithParamInterface<int> {
 protected:
  // In a period of the buses, `GetParam` ms after its begin, with torque at both drives.
  void StartInPhase() {
    StartRun();
    ASSERT_TRUE(rig_->RunUntil(500 * kMs, [this] {
      return rig_->executor.now_ns() % kPeriodNs == GetParam() * kMs &&
             rig_->world->drives_make_torque();
    }));
  }

  // From now until no drive makes torque, ms; relay open at the end.
  double TorqueLasts_ms() {
    const std::int64_t begin_ns = rig_->executor.now_ns();
    EXPECT_TRUE(rig_->RunUntil(50 * kMs, [this] { return !rig_->world->drives_make_torque(); }));
    EXPECT_FALSE(rig_->world->lines.relay);
    EXPECT_TRUE(rig_->tripped()) << ToString(rig_->permit().state);
    return static_cast<double>(rig_->executor.now_ns() - begin_ns) * 1e-6;
  }
};

TEST_P(StopReaction, ALimitSwitchEndsTheTorqueAtTheDrivesWithinFourMilliseconds) {
  StartInPhase();
  rig_->world->lines.levels &= ~LineBit(Line::kLimit2High);
  EXPECT_LE(TorqueLasts_ms(), 4.0);
  EXPECT_EQ(rig_->permit().cause, TripCause::kLimitSwitch2High);
  rig_->RunFor(200 * kMs);
  EXPECT_EQ(rig_->Failed(), 0U) << "the buses go on";
}

INSTANTIATE_TEST_SUITE_P(Phase, StopReaction, testing::Range(0, 20));

class StopReactionOf : public StopReaction {};

TEST_P(StopReactionOf, AnEmergencyStopOnAWeldedRelayIsTheSame) {
  StartInPhase();
  rig_->world->lines.welded = true;
  rig_->world->lines.levels &= ~LineBit(Line::kEmergencyStop);
  EXPECT_LE(TorqueLasts_ms(), 4.0);
}

// The write of a tick is judged in the next. The relay keeps its level; the pump stands still, and
// the hardware removes the power after 5 ms.
TEST_P(StopReactionOf, AWriteThatFailsIsNamedAndTheDrivesAreOffThoughTheRelayIsStuck) {
  StartInPhase();
  rig_->world->lines.write.ok = false;
  ASSERT_TRUE(rig_->RunUntil(4 * kMs, [this] { return !rig_->world->drives_make_torque(); }));
  EXPECT_TRUE(rig_->tripped());
  EXPECT_EQ(rig_->permit().cause, TripCause::kSafetyLines);
  EXPECT_EQ(rig_->permit().evidence.channel, static_cast<std::uint32_t>(LineTrouble::kWriteFailed));
  EXPECT_TRUE(rig_->world->lines.relay);
  rig_->RunFor(5 * kMs);
  EXPECT_FALSE(rig_->world->lines.PowerOn(rig_->executor.now_ns()));
}

// The trip is the emergency stop's; the weld shows when the relay should have opened, and keeps the
// arm from being used again.
TEST_P(StopReactionOf, AWeldedRelayWithAMirrorContactIsNotArmedAgain) {
  StartInPhase();
  rig_->world->lines.has_contact = true;
  rig_->world->lines.welded = true;
  rig_->world->lines.levels &= ~LineBit(Line::kEmergencyStop);
  EXPECT_LE(TorqueLasts_ms(), 4.0);
  rig_->world->lines.levels = kHealthyLevels | LineBit(Line::kResetButton);
  rig_->RunFor(3000 * kMs);
  EXPECT_EQ(rig_->Ask(RequestKind::kReset), Refusal::kCauseRemains);
  rig_->world->lines.welded = false;
  rig_->RunFor(20 * kMs);
  EXPECT_EQ(rig_->Ask(RequestKind::kReset), Refusal::kNone);
}

INSTANTIATE_TEST_SUITE_P(Phase, StopReactionOf, testing::Values(0, 1, 10, 19));

}  // namespace
}  // namespace flexarm
