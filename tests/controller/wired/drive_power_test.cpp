#include <gtest/gtest.h>

#include <string>

#include "tests/controller/wired/hostile_rig.h"
#include "tests/controller/wired/supply_models.h"
#include "tests/support/campaign.h"

// Drives that the relay feeds, and faults of drives, with the whole stack.

namespace flexarm {
namespace {

class DrivePowerCycles : public HostileBus, public testing::WithParamInterface<DriveSupplyModel> {
 protected:
  bool On() {
    return rig_->world->node(CanopenRole::kDrive1).state() == DriveState::kOperationEnabled &&
           rig_->world->node(CanopenRole::kDrive2).state() == DriveState::kOperationEnabled;
  }
};

INSTANTIATE_TEST_SUITE_P(Supply, DrivePowerCycles, kSupplyModels, NameOfSupply);

// Every fifth one runs the experiment for a moment.
TEST_P(DrivePowerCycles, CampaignOfArmsAndDisarmsNeverTrips) {
  ASSERT_NO_FATAL_FAILURE(StartIdle(ModbusTransport::kTcp, GetParam()));
  const long cycles = CampaignCases(10, 100);
  for (long cycle = 0; cycle < cycles; ++cycle) {
    SCOPED_TRACE(cycle);
    ASSERT_EQ(rig_->world->node(CanopenRole::kDrive1).state(), DriveState::kFault);
    ASSERT_TRUE(rig_->RunUntil(2000 * kMs, [this] { return rig_->last.output.at_rest != 0; }));
    rig_->RunFor(20 * kMs);
    ASSERT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
    if (cycle % 5 == 4) {
      ASSERT_EQ(rig_->Ask(RequestKind::kRun), Refusal::kNone);
      rig_->RunFor(100 * kMs);
      ASSERT_EQ(rig_->permit().state, SafetyState::kRunning) << ToString(rig_->permit().cause);
      rig_->Stop();
    }
    ASSERT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return On(); }));
    rig_->Disarm();
    rig_->RunFor(100 * kMs);
    ASSERT_EQ(rig_->permit().state, SafetyState::kIdle) << ToString(rig_->permit().cause);
  }
  EXPECT_EQ(rig_->Failed(), 0U);
  EXPECT_EQ(rig_->commissioner.angles().unknown(), 0);
}

// The relay opens in the tick of the trip, and the drives lose their supply in operation.
TEST_P(DrivePowerCycles, ATripIsResetWithoutAnotherCause) {
  ASSERT_NO_FATAL_FAILURE(StartRun(ModbusTransport::kTcp, GetParam()));
  rig_->world->lines.levels &= ~LineBit(Line::kEmergencyStop);
  rig_->RunFor(500 * kMs);
  ASSERT_EQ(rig_->permit().cause, TripCause::kEmergencyStop);
  EXPECT_EQ(rig_->world->node(CanopenRole::kDrive2).state(), DriveState::kFault);
  EXPECT_NE(rig_->stack->buses()[0].notice, "");
  EXPECT_EQ(rig_->Failed(), 0U);
  rig_->world->lines.levels = kHealthyLevels;
  ExpectArmable([] {});
  EXPECT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return On(); }));
}

// A contactor that drops, or the mains: while the drives operate, that is a fault.
TEST_P(DrivePowerCycles, ASupplyThatFailsInOperationTripsAndIsAcknowledged) {
  ASSERT_NO_FATAL_FAILURE(StartRun(ModbusTransport::kTcp, GetParam()));
  rig_->world->supply_fails = true;
  ExpectNamed("vcan0: node 1 (drive1): emergency message 0x");
  EXPECT_EQ(rig_->permit().cause, TripCause::kDriveFault);
  ExpectArmable([this] { rig_->world->supply_fails = false; });
  EXPECT_TRUE(rig_->RunUntil(1000 * kMs, [this] { return On(); }));
}

// The supply does not come: the enabling ends after a second, with its name.
TEST_P(DrivePowerCycles, ASupplyThatDoesNotComeRefusesTheRunAndTrips) {
  ASSERT_NO_FATAL_FAILURE(StartIdle(ModbusTransport::kTcp, GetParam()));
  rig_->world->supply_fails = true;
  ASSERT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
  EXPECT_NE(rig_->Ask(RequestKind::kRun), Refusal::kNone);
  ExpectNamed("node 1 (drive1): is switched on but gets no supply, emergency message 0x");
  ExpectArmable([this] { rig_->world->supply_fails = false; });
}

// In which state the fault comes.
class DriveFault : public HostileBus, public testing::WithParamInterface<SafetyState> {
 protected:
  void Start() {
    if (GetParam() == SafetyState::kRunning) return StartRun();
    ASSERT_NO_FATAL_FAILURE(StartIdle());
    if (GetParam() == SafetyState::kIdle) return;
    ASSERT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
    rig_->RunFor(200 * kMs);
    ASSERT_EQ(rig_->permit().state, SafetyState::kArmed);
  }
  SimulatedNode& drive() { return rig_->world->node(CanopenRole::kDrive1); }
  void Fail() {
    drive().RaiseFault(0x2310);
    ExpectNamed("vcan0: node 1 (drive1): emergency message 0x2310");
    EXPECT_EQ(rig_->permit().cause, TripCause::kDriveFault);
  }
};

std::string NameOfState(const testing::TestParamInfo<SafetyState>& state) {
  return ToString(state.param);
}

INSTANTIATE_TEST_SUITE_P(In, DriveFault,
                         testing::Values(SafetyState::kIdle, SafetyState::kArmed,
                                         SafetyState::kRunning),
                         NameOfState);

TEST_P(DriveFault, StaysUntilTheOperatorResets) {
  ASSERT_NO_FATAL_FAILURE(Start());
  Fail();
  rig_->RunFor(5000 * kMs);
  EXPECT_EQ(drive().state(), DriveState::kFault);
  const BusHealth health = rig_->stack->buses()[0];
  EXPECT_TRUE(health.ok) << "the bus answers";
  EXPECT_TRUE(health.in_fault);
  EXPECT_EQ(health.fault, "vcan0: node 1 (drive1): emergency message 0x2310");
  EXPECT_EQ(rig_->Failed(), failed_before_ + 1) << "counted once";
  EXPECT_EQ(rig_->Ask(RequestKind::kReset), Refusal::kCauseRemains) << "no button was pressed";
  EXPECT_EQ(drive().state(), DriveState::kFault) << "so nothing was acknowledged";
  rig_->PressButton();
  EXPECT_EQ(drive().state(), DriveState::kFault) << "nor by the button alone";
  EXPECT_EQ(rig_->Ask(RequestKind::kReset), Refusal::kNone) << CauseNames(rig_->present);
  EXPECT_NE(drive().state(), DriveState::kFault);
  EXPECT_FALSE(rig_->stack->buses()[0].in_fault);
  EXPECT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
  EXPECT_EQ(rig_->Ask(RequestKind::kRun), Refusal::kNone);
  EXPECT_EQ(rig_->commissioner.WhyNoRun(), "") << "the encoders were read all the time";
}

TEST_P(DriveFault, WhoseCauseRemainsRefusesTheResetAfterTwoSeconds) {
  ASSERT_NO_FATAL_FAILURE(Start());
  Fail();
  drive().Misbehave({.statusword = EncodeDriveState(DriveState::kFault)});
  rig_->RunFor(1000 * kMs);
  rig_->PressButton();
  const std::int64_t asked_ns = rig_->executor.now_ns();
  EXPECT_EQ(rig_->Ask(RequestKind::kReset), Refusal::kCauseRemains);
  EXPECT_NEAR(static_cast<double>(rig_->executor.now_ns() - asked_ns) * 1e-6, 2000.0, 10.0);
  drive().Misbehave({});
  drive().RaiseFault(0x2310);
  rig_->RunFor(3000 * kMs);
  EXPECT_EQ(drive().state(), DriveState::kFault) << "the request is over: nothing acknowledges";
  EXPECT_EQ(rig_->Ask(RequestKind::kReset), Refusal::kNone) << CauseNames(rig_->present);
}

}  // namespace
}  // namespace flexarm
