#include <gtest/gtest.h>

#include <algorithm>

#include "tests/hal/canopen/canopen_bench.h"

namespace flexarm {
namespace {

constexpr BusCommand kTorque{.torque_nm = {9.0, 3.0}, .enabled = true};
constexpr BusCommand kOff = CanopenBench::kOff;

// Each test checks the bound that the device declares, on every call, in virtual time.
class CanopenFaults : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(bench_.Enable(kTorque));
    ASSERT_EQ(bench_.node(0).torque_per_mille(), 300);
    bench_.Heard();
  }

  BusStatus Exchange(const BusCommand& command) {
    bench_.NextPeriod();
    const std::int64_t begin_ns = bench_.now_ns();
    const BusStatus status = device().Exchange(command, &bench_.frame);
    EXPECT_LE(bench_.now_ns() - begin_ns, device().worst_case_ns());
    const bool answers = status == BusStatus::kDriveFault && !device().needs_reconnect();
    if (status != BusStatus::kOk && !answers) {
      EXPECT_EQ(bench_.frame.counter_valid, 0U) << "on failure no reading is valid";
    }
    return status;
  }

  BusStatus Reconnect() {
    bench_.NextPeriod();
    const std::int64_t begin_ns = bench_.now_ns();
    const BusStatus status = device().Reconnect();
    EXPECT_LE(bench_.now_ns() - begin_ns, device().worst_case_ns());
    return status;
  }

  // With the operator's acknowledgement of drive faults.
  BusStatus RecoverUntilOk(int attempts) {
    BusStatus status = BusStatus::kTimeout;
    for (int k = 0; k < attempts && status != BusStatus::kOk; ++k) {
      status = device().needs_reconnect() ? Reconnect() : Exchange(CanopenBench::kAcknowledge);
    }
    return status;
  }

  // Applies this fate to the next frame with this identifier, and to no other.
  void TamperOnce(std::uint32_t id, MemoryWire::Fate fate) {
    bench_.wire.SetTamper([id, fate, done = false](CanFrame* frame) mutable {
      if (done || frame->id != id) return MemoryWire::Fate{};
      done = true;
      return fate;
    });
  }

  // No node acknowledges any more; frames sent before are out.
  void Cut() {
    bench_.wire.AdvanceTo(bench_.now_ns() + kMs);
    bench_.wire.SetStalled(true);
  }

  // A frame that another node on the bus sends now.
  void SendForeign(const CanFrame& frame) {
    ASSERT_EQ(bench_.spy.Send(frame), SendResult::kSent);
    bench_.wire.AdvanceTo(bench_.now_ns() + kMs);
  }

  CanopenDevice& device() { return *bench_.device; }
  const CanopenFault& fault() { return device().fault(); }
  int torque(std::size_t drive) { return bench_.node(drive).torque_per_mille(); }

  CanopenBench bench_;
};

TEST_F(CanopenFaults, ALostFrameIsAFailedExchangeAndNoFault) {
  for (const std::uint32_t lost : {CobId(kCobTpdo, 2), CobId(kCobTpdo, 11), kCobSync}) {
    TamperOnce(lost, {.copies = 0});
    EXPECT_EQ(Exchange(kTorque), BusStatus::kTimeout) << lost;
    EXPECT_EQ(Exchange(kTorque), BusStatus::kOk) << lost;
    EXPECT_EQ(torque(0), 300);
  }
  EXPECT_EQ(fault().kind, CanopenFaultKind::kNone);
  EXPECT_GE(device().counts().missed, 2U);
}

TEST_F(CanopenFaults, ALostCommandLeavesTheLastOneInEffectForOnePeriod) {
  TamperOnce(CobId(kCobRpdo, 1), {.copies = 0});
  EXPECT_EQ(Exchange({.torque_nm = {0.0, 0.0}, .enabled = true}), BusStatus::kOk);
  EXPECT_EQ(torque(0), 300);
  EXPECT_EQ(Exchange({.torque_nm = {0.0, 0.0}, .enabled = true}), BusStatus::kOk);
  EXPECT_EQ(torque(0), 0);
}

TEST_F(CanopenFaults, ADuplicatedAnswerIsCountedAndTheFirstIsUsed) {
  bench_.node(2).SetPosition(41);
  TamperOnce(CobId(kCobTpdo, 11), {.copies = 2});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kOk);
  EXPECT_EQ(bench_.frame.counter[0], 41U);
  EXPECT_EQ(device().counts().duplicated, 1U);
}

// The late answer arrives 12 ms after its SYNC, after the exchange; at the next one it is old.
TEST_F(CanopenFaults, ALateAnswerIsRejectedByItsTimeStamp) {
  bench_.node(2).SetPosition(41);
  TamperOnce(CobId(kCobTpdo, 11), {.delay_ns = 12 * kMs});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kTimeout);
  bench_.node(2).SetPosition(42);
  EXPECT_EQ(Exchange(kTorque), BusStatus::kOk);
  EXPECT_EQ(bench_.frame.counter[0], 42U) << "41 belongs to the previous SYNC";
  EXPECT_EQ(device().counts().stale, 1U);
}

// An answer late by one period minus half a frame arrives just before the fresh one, when no time
// stamp can distinguish them: after a miss both are awaited, and the second is used.
TEST_F(CanopenFaults, AnAnswerLateByOnePeriodIsNotMistakenForTheNext) {
  bench_.node(5).SetPosition(41);
  TamperOnce(CobId(kCobTpdo, 14), {.delay_ns = 20 * kMs - kMs / 25});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kTimeout);
  bench_.node(5).SetPosition(42);
  EXPECT_EQ(Exchange(kTorque), BusStatus::kOk);
  EXPECT_EQ(bench_.frame.counter[3], 42U);
  EXPECT_EQ(device().counts().duplicated, 1U) << "the late one arrived as this test requires";
}

// It arrived after the queue was emptied and before SYNC was sent: only its time stamp shows that.
TEST_F(CanopenFaults, AnAnswerFromBeforeTheSyncIsStaleWheneverItIsRead) {
  TamperOnce(CobId(kCobTpdo, 11), {.waited_ns = 2 * kMs});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kTimeout);
  EXPECT_EQ(device().counts().stale, 1U);
}

TEST_F(CanopenFaults, AnAnswerWithoutItsSyncIsStale) {
  SendForeign(EncodeEncoderPosition(11, 999));
  EXPECT_EQ(Exchange(kTorque), BusStatus::kOk);
  EXPECT_NE(bench_.frame.counter[0], 999U);
  EXPECT_EQ(device().counts().stale, 1U);
}

TEST_F(CanopenFaults, ASilentDriveIsADriveFaultAfterThreeMissedAnswers) {
  bench_.node(1).Misbehave({.answers_no_sync = true});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kTimeout);
  EXPECT_EQ(Exchange(kTorque), BusStatus::kTimeout);
  EXPECT_EQ(Exchange(kTorque), BusStatus::kDriveFault);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kSilent);
  EXPECT_EQ(fault().node_id, 2);
  EXPECT_EQ(CanopenFaultText(device().config(), fault()),
            "can0: node 2 (drive2): does not answer SYNC");
  EXPECT_EQ(Exchange(kTorque), BusStatus::kDriveFault);
  EXPECT_EQ(torque(0), 0) << "one drive's fault removes the torque of both";
  EXPECT_EQ(torque(1), 0) << "it still receives";
}

TEST_F(CanopenFaults, ASilentEncoderIsALostNodeNotADriveFault) {
  bench_.node(4).Misbehave({.silent = true});
  for (int k = 0; k < 3; ++k) static_cast<void>(Exchange(kTorque));
  EXPECT_EQ(Exchange(kTorque), BusStatus::kDisconnected);
  EXPECT_EQ(fault().node_id, 13);
}

TEST_F(CanopenFaults, AnEmergencyIsADriveFaultWithItsCodeAtTheNextExchange) {
  bench_.node(0).RaiseFault(0x2310);
  EXPECT_EQ(Exchange(kTorque), BusStatus::kDriveFault);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kEmergency);
  EXPECT_EQ(fault().node_id, 1);
  EXPECT_EQ(fault().code, 0x2310);
  EXPECT_EQ(CanopenFaultText(device().config(), fault()),
            "can0: node 1 (drive1): emergency message 0x2310");
  EXPECT_EQ(torque(1), 0) << "switched off in this exchange";
}

TEST_F(CanopenFaults, TheEndOfAnEmergencyIsNoFault) {
  SendForeign(EncodeEmergency(1, {.code = 0, .error_register = 0, .vendor_bytes = {}}));
  EXPECT_EQ(Exchange(kTorque), BusStatus::kOk);
}

TEST_F(CanopenFaults, ADriveInFaultIsDetectedByItsStatuswordIfTheEmergencyIsLost) {
  TamperOnce(CobId(kCobEmergency, 2), {.copies = 0});
  bench_.node(1).RaiseFault(0x3210);
  EXPECT_EQ(Exchange(kTorque), BusStatus::kDriveFault);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kDriveFault);
  EXPECT_EQ(fault().code, EncodeDriveState(DriveState::kFault));
}

// node_timeout_ms is 120: the last heartbeat may be 50 ms old when it stops, so between 70 ms and
// 120 ms and one exchange later.
TEST_F(CanopenFaults, ALostHeartbeatIsAFaultEvenIfTheNodeAnswersSync) {
  bench_.node(0).Misbehave({.no_heartbeat = true});
  int exchanges = 0;
  while (Exchange(kTorque) == BusStatus::kOk && exchanges < 100) ++exchanges;
  EXPECT_GE(exchanges, 3);
  EXPECT_LE(exchanges, 7);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kHeartbeatLost);
  EXPECT_EQ(fault().node_id, 1);
}

TEST_F(CanopenFaults, ANodeThatRebootsHasLeftTheOperationalState) {
  SendForeign(EncodeNmt(NmtCommand::kResetNode, 2));
  EXPECT_EQ(Exchange(kTorque), BusStatus::kDriveFault);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kNotOperational);
  EXPECT_EQ(fault().node_id, 2);
  ASSERT_EQ(RecoverUntilOk(100), BusStatus::kOk) << "configured again";
  EXPECT_EQ(bench_.node(1).Value(kObjectModeDisplay), kCyclicTorqueMode);
  EXPECT_TRUE(bench_.EnableOpened());
}

TEST_F(CanopenFaults, ADriveThatSwitchesItsTorqueOffByItselfIsAFault) {
  bench_.node(0).Misbehave({.statusword = EncodeDriveState(DriveState::kQuickStopActive)});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kDriveFault);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kLeftOperation);
  EXPECT_EQ(fault().code, 0x0217);
}

TEST_F(CanopenFaults, AStatuswordStuckInOperationIsAFaultWhenTheDriveMustBeOff) {
  bench_.node(1).Misbehave({.statusword = EncodeDriveState(DriveState::kOperationEnabled)});
  EXPECT_EQ(Exchange(kOff), BusStatus::kOk);
  int exchanges = 1;
  while (Exchange(kOff) == BusStatus::kOk && exchanges < 100) ++exchanges;
  EXPECT_EQ(exchanges, 5);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kNotDisabled);
  EXPECT_EQ(fault().node_id, 2);
}

TEST_F(CanopenFaults, ADriveThatDoesNotEnableIsAFaultAfterASecond) {
  for (int k = 0; k < 3; ++k) ASSERT_EQ(Exchange(kOff), BusStatus::kOk);
  bench_.node(1).Misbehave({.statusword = EncodeDriveState(DriveState::kSwitchOnDisabled)});
  int exchanges = 0;
  while (Exchange(kTorque) == BusStatus::kOk && exchanges < 1000) ++exchanges;
  EXPECT_EQ(exchanges, 50);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kNotEnabled);
  EXPECT_EQ(torque(1), 0);
}

TEST_F(CanopenFaults, APdoOfAWrongLengthIsMalformedAndNotUsed) {
  bench_.node(3).Misbehave({.cuts_pdos = true});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kMalformed);
  EXPECT_EQ(device().counts().malformed, 1U);
  bench_.node(3).Misbehave({});
  EXPECT_EQ(Exchange(kTorque), BusStatus::kOk);
}

TEST_F(CanopenFaults, ASecondMasterOnTheBusIsAFault) {
  SendForeign(EncodeSync());
  EXPECT_EQ(Exchange(kTorque), BusStatus::kMalformed);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kSecondMaster);
  EXPECT_EQ(torque(0), 0);
}

// Pitfall 6.
TEST_F(CanopenFaults, BusOffIsReportedNothingIsSentAndOnlyReconnectRecovers) {
  bench_.master->SetBusOff();
  EXPECT_EQ(Exchange(kTorque), BusStatus::kBusOff);
  bench_.wire.AdvanceTo(bench_.now_ns() + 100 * kMs);
  EXPECT_EQ(torque(0), 0) << "the drives miss the heartbeat";
  EXPECT_EQ(torque(1), 0);
  const std::uint64_t sent = bench_.master->counts().sent;
  for (int k = 0; k < 10; ++k) EXPECT_EQ(Exchange(kTorque), BusStatus::kBusOff);
  EXPECT_EQ(bench_.master->counts().sent, sent);

  bench_.master->SetRestartable(false);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(Reconnect(), BusStatus::kBusOff);
  bench_.master->SetRestartable(true);
  ASSERT_EQ(RecoverUntilOk(100), BusStatus::kOk);
  EXPECT_EQ(bench_.node(0).state(), DriveState::kSwitchOnDisabled) << "recovered, and disarmed";
  EXPECT_TRUE(bench_.EnableOpened());
}

// Pitfall 8: with room for two frames the SYNC is rejected; without SYNC no command acts.
TEST_F(CanopenFaults, AFullTransmitQueueIsCountedAndAFaultAfterThreeExchanges) {
  bench_.master->SetTransmitQueue(2);
  EXPECT_EQ(Exchange(kOff), BusStatus::kTimeout);
  EXPECT_EQ(bench_.master->counts().queue_full, 1U);
  EXPECT_EQ(Exchange(kOff), BusStatus::kTimeout);
  EXPECT_EQ(Exchange(kOff), BusStatus::kDisconnected);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kTransmitStuck);
  ASSERT_EQ(device().counter_names().size(), 7U);
  EXPECT_STREQ(device().counter_names()[4], "unsent_exchanges");
  EXPECT_EQ(device().counter_values()[4], 3U);
  EXPECT_STREQ(device().counter_names()[5], "refused_sends");
  EXPECT_EQ(device().counter_values()[5], 3U);
  bench_.wire.AdvanceTo(bench_.now_ns() + 2 * kMs);
  EXPECT_EQ(torque(0), 0) << "three exchanges without heartbeat: the drives are off";
  bench_.master->SetTransmitQueue(16);
  EXPECT_EQ(RecoverUntilOk(100), BusStatus::kOk);
}

// Pitfall 7. The bus is interrupted while the arm moves, the daemon continues, the emergency stop
// is pressed, and then the bus recovers.
TEST_F(CanopenFaults, NothingThatWasQueuedBeforeAStopIsSentAfterReconnect) {
  Cut();
  EXPECT_EQ(Exchange(kTorque), BusStatus::kTimeout);
  for (int k = 0; k < 5; ++k) EXPECT_NE(Exchange(kOff), BusStatus::kOk);
  EXPECT_TRUE(bench_.master->unsent()) << "the queue is not empty";
  bench_.Heard();
  EXPECT_EQ(Reconnect(), BusStatus::kTimeout) << "empties the queue";
  bench_.wire.SetStalled(false);
  ASSERT_EQ(RecoverUntilOk(100), BusStatus::kOk);
  for (const ReceivedFrame& heard : bench_.Heard()) {
    if (heard.frame.id != CobId(kCobRpdo, 1) && heard.frame.id != CobId(kCobRpdo, 2)) continue;
    EXPECT_EQ(DecodeDriveCommand(heard.frame)->torque_per_mille, 0);
    EXPECT_EQ(DecodeDriveCommand(heard.frame)->controlword & 0x02, 0) << "voltage stays off";
  }
}

TEST_F(CanopenFaults, AtMostOneExchangeIsQueuedAndTheDriveIgnoresItWhenLate) {
  Cut();
  for (int k = 0; k < 20; ++k) static_cast<void>(Exchange(kTorque));
  bench_.Heard();
  bench_.wire.SetStalled(false);
  int most_torque = 0;
  for (int ms = 0; ms < 20; ++ms) {
    bench_.wire.AdvanceTo(bench_.now_ns() + kMs);
    most_torque = std::max(most_torque, torque(0));
  }
  int commands = 0;
  for (const ReceivedFrame& heard : bench_.Heard()) {
    commands += heard.frame.id == CobId(kCobRpdo, 1) ? 1 : 0;
  }
  EXPECT_EQ(commands, 1);
  EXPECT_EQ(most_torque, 0);
}

// Pitfall 9. The time-out is 60 ms from the last heartbeat, which has the lowest priority and ends
// at most 1 ms after its exchange; the drive checks its timer every 0.1 ms here.
TEST_F(CanopenFaults, TheDrivesRemoveTheirTorqueWithinTheirTimeOutWhenTheDaemonDies) {
  ASSERT_EQ(Exchange(kTorque), BusStatus::kOk);
  const std::int64_t died_ns = bench_.now_ns();
  bench_.wire.AdvanceTo(died_ns + 50 * kMs);
  EXPECT_EQ(torque(0), 300) << "a late daemon is not a dead one";
  bench_.wire.AdvanceTo(died_ns + 62 * kMs);
  EXPECT_EQ(torque(0), 0);
  EXPECT_EQ(torque(1), 0);
}

TEST_F(CanopenFaults, WithoutItsHeartbeatConsumerADriveKeepsItsTorque) {
  bench_.node(0).Misbehave({.keeps_torque = true});
  bench_.wire.AdvanceTo(bench_.now_ns() + 1000 * kMs);
  EXPECT_EQ(torque(0), 300) << "shows that the test above depends on the configuration";
  EXPECT_EQ(torque(1), 0);
}

TEST_F(CanopenFaults, ANodeThatLostPowerIsConfiguredAgainWithinBoundedCalls) {
  bench_.node(0).Misbehave({.silent = true});
  bench_.node(5).Misbehave({.silent = true});
  for (int k = 0; k < 10; ++k) static_cast<void>(Exchange(kOff));
  for (int k = 0; k < 60; ++k) EXPECT_NE(Reconnect(), BusStatus::kOk);
  bench_.node(0).Misbehave({});
  bench_.node(5).Misbehave({});
  ASSERT_EQ(RecoverUntilOk(100), BusStatus::kOk);
  EXPECT_TRUE(bench_.EnableOpened());
}

// A foreign node at full rate: with the lowest priority it delays by one frame; with the highest
// no other frame is sent, which must be detected in bounded time.
TEST_F(CanopenFaults, AFloodOfForeignFramesDelaysByOneFrameOrIsNamed) {
  CanFrame foreign{.id = 0x7F0, .length = 8};
  bench_.wire.AddRunner([this, &foreign] {
    if (!bench_.spy.unsent()) static_cast<void>(bench_.spy.Send(foreign));
  });
  const std::uint64_t before = bench_.master->counts().received;
  for (int k = 0; k < 50; ++k) ASSERT_EQ(Exchange(kTorque), BusStatus::kOk);
  EXPECT_LT(bench_.master->counts().received - before, 50U * 15U)
      << "foreign identifiers are filtered";
  foreign.id = 0x001;
  for (int k = 0; k < 5; ++k) EXPECT_NE(Exchange(kTorque), BusStatus::kOk);
  EXPECT_EQ(fault().kind, CanopenFaultKind::kTransmitStuck);
  bench_.wire.AdvanceTo(bench_.now_ns() + 60 * kMs);
  EXPECT_EQ(torque(0), 0);
}

TEST_F(CanopenFaults, AFloodWithANodesOwnIdentifierIsBounded) {
  const CanFrame babble = EncodeEncoderPosition(11, 7);
  bench_.wire.AddRunner([this, &babble] {
    if (!bench_.spy.unsent()) static_cast<void>(bench_.spy.Send(babble));
  });
  for (int k = 0; k < 20; ++k) static_cast<void>(Exchange(kTorque));
  EXPECT_GT(device().counts().stale, 1000U);
}

// Fixed seed: a thousand exchanges on a bus that loses, repeats, delays and damages frames. The
// result is a failed exchange or a named fault; a valid reading belongs to this SYNC.
TEST_F(CanopenFaults, ABadBusNeverGivesAReadingOfAnotherSync) {
  std::uint32_t random = 1;
  const auto Roll = [&random](std::uint32_t sides) {
    random = random * 1664525U + 1013904223U;
    return (random >> 8U) % sides;
  };
  const auto Tamper = [&](CanFrame* frame) {
    MemoryWire::Fate fate{};
    if (Roll(50) == 0) fate.copies = 0;
    if (Roll(50) == 0) fate.copies = 2;
    if (Roll(50) == 0) fate.delay_ns = Roll(19) * kMs;  // within its period
    if (Roll(50) == 0 && frame->length > 0) --frame->length;
    return fate;
  };
  bench_.wire.SetTamper(Tamper);
  int good = 0, faults = 0;
  for (std::uint32_t k = 1; k <= 1000; ++k) {
    for (const std::size_t encoder : {2U, 3U, 4U, 5U}) bench_.node(encoder).SetPosition(k);
    if (Exchange(kOff) == BusStatus::kOk) {
      ++good;
      for (const std::uint32_t counter : bench_.frame.counter) ASSERT_EQ(counter, k);
    }
    if (fault().kind == CanopenFaultKind::kNone) continue;
    ++faults;
    bench_.wire.SetTamper(nullptr);
    ASSERT_EQ(RecoverUntilOk(200), BusStatus::kOk);
    bench_.wire.SetTamper(Tamper);
  }
  EXPECT_GT(good, 500) << faults << " faults";
  EXPECT_LT(good, 950) << "the bus had too few faults for this test";
}

}  // namespace
}  // namespace flexarm
