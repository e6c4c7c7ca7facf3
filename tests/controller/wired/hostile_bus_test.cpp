#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "tests/controller/wired/hostile_rig.h"

// The complete stack with its real drivers, during a run, when a device fails. A failed exchange
// with an amplifier takes as long as its driver declares, on the simulated clock of the test. For
// every fault:
// - control and safety begin every activation at its instant and miss none;
// - every value that the loop uses as a reading was present at the instant that it states;
// - a single failure is survived and counted; else it trips with a cause that names the device, and
//   the drives' torque ends;
// - after the repair the bus comes back while disarmed, and the arm can be armed again.

namespace flexarm {
namespace {

struct OnWire {
  ModbusTransport transport;
  WireFault fault;
};

void PrintTo(const OnWire& tested, std::ostream* out) { *out << ToString(tested.fault); }

class HostileAmplifier : public HostileBus, public testing::WithParamInterface<OnWire> {};

TEST_P(HostileAmplifier, IsNamedCausesNoDelayAndComesBack) {
  StartRun(GetParam().transport);
  Behave(GetParam().fault, std::chrono::seconds(5));
  ExpectNamed("modbus 'strain-amplifier-1'");
  ExpectArmable([this] { Behave(WireFault::kNone); });
}

// Without kTwice, which makes the bus unreliable (below). Over a serial line without kOneBehind:
// its replies have no number, so a device that answers in time with the values of the period
// before, and never missed a reply, cannot be distinguished from one with a slow filter. After a
// missed reply it is detected: HostilePeerOver.RepliesOfAPeerThatIsAlwaysLateAreNeverAccepted.
std::vector<OnWire> AllFaults() {
  using enum WireFault;
  std::vector<OnWire> all;
  for (int i = 1; i < kWireFaults; ++i) {
    const auto fault = static_cast<WireFault>(i);
    if (fault == kBadChecksum || fault == kTwice) continue;
    all.push_back({ModbusTransport::kTcp, fault});
  }
  for (const WireFault fault :
       {kSilent, kLate, kByteByByte, kWrongUnit, kWrongFunction, kLongPayload, kShortPayload,
        kHugePayload, kBadChecksum, kGarbage, kThreeBytes, kHalfFrame, kException, kFlood, kAway}) {
    all.push_back({ModbusTransport::kRtu, fault});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, HostileAmplifier, testing::ValuesIn(AllFaults()),
                         [](const testing::TestParamInfo<OnWire>& tested) {
                           std::string name =
                               tested.param.transport == ModbusTransport::kTcp ? "Tcp" : "Rtu";
                           for (const char* c = ToString(tested.param.fault); *c != '\0'; ++c) {
                             name += *c == '-' ? '_' : *c;
                           }
                           return name;
                         });

TEST_F(HostileBus, AHealthyRigKeepsRunning) {
  StartRun();
  rig_->RunFor(2000 * kMs);
  EXPECT_EQ(rig_->permit().state, SafetyState::kRunning) << ToString(rig_->permit().cause);
  EXPECT_EQ(rig_->Failed(), 0U);
}

TEST_F(HostileBus, OneFailedExchangeIsCountedAndSurvived) {
  StartRun();
  Behave(WireFault::kSilent);
  ASSERT_TRUE(rig_->RunUntil(40 * kMs, [this] { return rig_->Failed() > 0; }));
  Behave(WireFault::kNone);
  rig_->RunFor(1000 * kMs);
  EXPECT_EQ(rig_->permit().state, SafetyState::kRunning) << ToString(rig_->permit().cause);
  EXPECT_EQ(rig_->Failed(), 1U);
}

// An unexpected reply makes the next exchange fail, and the one after that succeeds. The bus is
// never lost: no two fail in a row. But it has half of the readings, and trips at the 16th failure.
TEST_F(HostileBus, RepliesThatComeTwiceMakeTheBusUnreliable) {
  StartRun();
  Behave(WireFault::kTwice);
  ASSERT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return rig_->tripped(); }));
  EXPECT_EQ(rig_->permit().cause, TripCause::kBusUnreliable) << ToString(rig_->permit().cause);
  EXPECT_EQ(rig_->Failed(), 16U) << "every second one";
  EXPECT_THAT(rig_->Named(),
              testing::StartsWith("strain-amplifier-1: 16 of the last 200 exchanges failed; the "
                                  "last: modbus 'strain-amplifier-1'"));
  EXPECT_FALSE(rig_->world->lines.relay);
  ExpectArmable([this] { Behave(WireFault::kNone); });
}

// Longer than any driver declares: the thread of the bus is blocked, and no other.
TEST_F(HostileBus, AnExchangeThatDoesNotEndIsNamedAndDelaysNoTask) {
  StartRun();
  rig_->hangs_ns = 300 * kMs;
  ExpectNamed("strain-amplifier-1: its exchange does not end");
  EXPECT_EQ(rig_->permit().cause, TripCause::kStaleFrame);
  ExpectArmable([this] { rig_->hangs_ns = 0; });
}

// Late by more than a period, repeatedly: periods are skipped, missing readings are marked as
// missing, and the trip names the bus. UnreliableRig counts exchanges that are slow, but less so.
TEST_F(HostileBus, ExchangesOfMoreThanAPeriodTripAndLeaveNoReadingOld) {
  StartRun();
  rig_->hangs_ns = 25 * kMs;
  ASSERT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return rig_->tripped(); }));
  EXPECT_THAT(rig_->permit().cause, testing::AnyOf(TripCause::kBusTooSlow, TripCause::kStaleFrame))
      << ToString(rig_->permit().cause);
  EXPECT_THAT(rig_->Named(), testing::StartsWith("strain-amplifier-1: "));
  EXPECT_EQ(rig_->stale, 0);
  ExpectArmable([this] { rig_->hangs_ns = 0; });
}

// Within the period, so that no other limit notices.
TEST_F(HostileBus, ExchangesThatOnlyTakeLongerThanDeclaredTrip) {
  StartRun();
  rig_->hangs_ns = rig_->buses[1]->worst_case_ns() + 1;
  ASSERT_LT(rig_->hangs_ns, 20 * kMs);
  ASSERT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return rig_->tripped(); }));
  EXPECT_EQ(rig_->permit().cause, TripCause::kBusTooSlow)
      << ToString(rig_->permit().cause) << " " << rig_->permit().evidence.value << " at "
      << rig_->executor.now_ns() << " slow " << rig_->stack->buses()[1].slow << " failed "
      << rig_->stack->buses()[1].failed << " " << rig_->stack->buses()[0].name;
  EXPECT_EQ(rig_->Failed(), 0U);
  ExpectArmable([this] { rig_->hangs_ns = 0; });
}

TEST_F(HostileBus, ABusThatHangsDoesNotKeepTheRelayClosedDuringAShutdown) {
  StartRun();
  rig_->hangs_ns = 10'000 * kMs;
  rig_->RunFor(20 * kMs);
  rig_->stack->RequestShutdown();
  EXPECT_TRUE(rig_->RunUntil(45 * kMs, [this] { return !rig_->world->lines.relay; }))
      << "two periods and a tick after its last exchange";
  rig_->RunFor(121 * kMs);
  EXPECT_FALSE(rig_->world->drives_make_torque());
  rig_->hangs_ns = 0;
}

class HostileNode : public HostileBus {
 protected:
  void ExpectNamedAndBack(CanopenRole role, const Misbehaviour& wrong, const std::string& text) {
    StartRun();
    rig_->world->node(role).Misbehave(wrong);
    ExpectNamed(text);
    ExpectArmable([this, role] { rig_->world->node(role).Misbehave({}); });
  }
};

TEST_F(HostileNode, ASilentDriveIsNamedAndComesBack) {
  ExpectNamedAndBack(CanopenRole::kDrive2, {.silent = true},
                     "vcan0: node 2 (drive2): does not answer SYNC");
}

TEST_F(HostileNode, ASilentEncoderIsNamedAndComesBack) {
  ExpectNamedAndBack(CanopenRole::kHub1, {.silent = true},
                     "vcan0: node 11 (hub1): does not answer SYNC");
}

TEST_F(HostileNode, ALostHeartbeatIsNamedAndComesBack) {
  ExpectNamedAndBack(CanopenRole::kDrive1, {.no_heartbeat = true},
                     "vcan0: node 1 (drive1): heartbeat lost");
}

TEST_F(HostileNode, ShortPdosAreNamedAndComeBack) {
  ExpectNamedAndBack(CanopenRole::kRotor1, {.cuts_pdos = true},
                     "vcan0: node 13 (rotor1): sends a malformed PDO");
}

TEST_F(HostileNode, AnEmergencyIsNamedAndReset) {
  StartRun();
  rig_->world->node(CanopenRole::kDrive1).RaiseFault(0x2310);
  ExpectNamed("vcan0: node 1 (drive1): emergency message 0x2310");
  EXPECT_EQ(rig_->permit().cause, TripCause::kDriveFault);
  ExpectArmable([] {});
}

TEST_F(HostileNode, BusOffIsNamedAndClearedWhileDisarmed) {
  StartRun();
  rig_->master->SetRestartable(false);
  rig_->master->SetBusOff();
  ExpectNamed("vcan0: the CAN controller has left the bus (bus-off)");
  ExpectArmable([this] { rig_->master->SetRestartable(true); });
}

TEST_F(HostileNode, ABusWithoutAcknowledgementIsNamedAndComesBack) {
  StartRun();
  rig_->world->wire.SetStalled(true);
  ExpectNamed("vcan0: frames are not sent, no node acknowledges");
  std::uint32_t unsent = 0;
  const std::vector<BusHealth> health = rig_->stack->buses();
  for (const BusCounter& counter : health[0].counters) {
    if (counter.name == std::string("unsent_exchanges")) unsent = counter.value;
  }
  EXPECT_GE(unsent, 3U) << "the status counts them";
  ExpectArmable([this] { rig_->world->wire.SetStalled(false); });
}

}  // namespace
}  // namespace flexarm
