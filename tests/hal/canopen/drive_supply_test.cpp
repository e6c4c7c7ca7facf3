#include <gtest/gtest.h>

#include <string>

#include "tests/hal/canopen/canopen_bench.h"

// Drives whose intermediate circuit is fed through the relay: what they report without power is no
// fault, and what they report in operation is one.

namespace flexarm {
namespace {

static_assert(SupplyEmergency(0x3220) && SupplyEmergency(0x3221) && SupplyEmergency(0x3120) &&
              SupplyEmergency(0x3130) && SupplyEmergency(0xFF01) && SupplyEmergency(0xFFFF));
static_assert(!SupplyEmergency(0x3110) && !SupplyEmergency(0x3210) && !SupplyEmergency(0x2310) &&
              !SupplyEmergency(0x8130) && !SupplyEmergency(0x0000) && !SupplyEmergency(0x3300));

class DriveSupplies : public testing::TestWithParam<DriveSupplyModel> {
 protected:
  static constexpr BusCommand kOff = CanopenBench::kOff;
  static constexpr BusCommand kOn{.torque_nm = {9.0, 3.0}, .enabled = true};

  static std::vector<SimulatedNodeConfig> Wired() {
    std::vector<SimulatedNodeConfig> wired = CanopenBench::Wired(BenchConfig());
    for (SimulatedNodeConfig& node : wired) {
      if (node.drive) node.supply = GetParam();
    }
    return wired;
  }

  void SetUp() override { bench_.device->Open(); }

  void Feed(bool fed) {
    for (const std::size_t drive : {0U, 1U}) bench_.node(drive).Feed(fed);
  }
  void ExpectWell(const BusCommand& command, int exchanges) {
    for (int k = 0; k < exchanges; ++k) {
      ASSERT_EQ(bench_.Exchange(command), BusStatus::kOk)
          << bench_.device->FaultText(bench_.device->FaultOf(BusStatus::kDriveFault));
    }
  }
  void SwitchOn() {
    Feed(true);
    ExpectWell(kOn, 45);
    ASSERT_EQ(bench_.device->drives_on(), 0b11U);
    ASSERT_EQ(bench_.node(0).torque_per_mille(), 300);
  }
  void ExpectVoltage(std::uint8_t on, std::uint8_t off) {
    EXPECT_EQ(bench_.device->voltage().on, on);
    EXPECT_EQ(bench_.device->voltage().off, off);
  }
  std::string Text(const BusFault& fault) { return bench_.device->FaultText(fault); }
  std::string Fault() { return Text(bench_.device->FaultOf(BusStatus::kDriveFault)); }

  CanopenBench bench_{BenchConfig(), Wired()};
};

std::string NameOf(const testing::TestParamInfo<DriveSupplyModel>& model) {
  if (model.param.clears_itself) return "ClearsItself";
  return model.param.safe_torque_off ? "SafeTorqueOff" : "Plain";
}

INSTANTIATE_TEST_SUITE_P(Model, DriveSupplies,
                         testing::Values(DriveSupplyModel{},
                                         DriveSupplyModel{.clears_itself = true},
                                         DriveSupplyModel{.safe_torque_off = true}),
                         NameOf);

TEST_P(DriveSupplies, WithTheRelayOpenItIsShownAndNoFault) {
  ExpectWell(kOff, 100);
  EXPECT_EQ(bench_.node(0).state(), DriveState::kFault) << "so it is no easy case";
  EXPECT_EQ(bench_.device->fault().kind, CanopenFaultKind::kNone);
  EXPECT_EQ(Text(bench_.device->notice()),
            std::string("can0: node 1 (drive1): has no supply while the relay is open, emergency "
                        "message 0x") +
                (GetParam().safe_torque_off ? "ff01" : "3220"));
}

TEST_P(DriveSupplies, TheDrivesAreSwitchedOnAndOffAgainAndAgain) {
  for (int cycle = 0; cycle < 10; ++cycle) {
    ExpectWell(kOff, 10);
    SwitchOn();
    EXPECT_EQ(bench_.device->notice(), BusFault{});
    ExpectWell(kOff, 1);  // off and confirmed, then the relay
    Feed(false);
  }
}

// A trip: the relay opens first, and the drives hear of it a moment later.
TEST_P(DriveSupplies, ATripThatOpensTheRelayFirstIsNoFaultOfTheDrives) {
  SwitchOn();
  Feed(false);
  bench_.wire.AdvanceTo(bench_.now_ns() + 4 * kMs);
  ASSERT_EQ(bench_.node(0).state(), DriveState::kFault);
  ASSERT_EQ(bench_.device->SwitchOff(), BusStatus::kOk);
  ExpectWell(kOff, 20);
  SwitchOn();
}

TEST_P(DriveSupplies, InOperationItIsAFaultThatTheOperatorAcknowledges) {
  SwitchOn();
  Feed(false);
  bench_.wire.AdvanceTo(bench_.now_ns() + 4 * kMs);
  EXPECT_EQ(bench_.Exchange(kOn), BusStatus::kDriveFault);
  EXPECT_NE(Fault().find("node 1 (drive1): emergency message 0x"), std::string::npos) << Fault();
  for (int k = 0; k < 50; ++k) EXPECT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk)
      << "the relay is open: the drive cannot leave the fault now";
  ExpectWell(kOff, 20);
  SwitchOn();
}

TEST_P(DriveSupplies, ASupplyThatDoesNotComeIsNamedAfterASecond) {
  ExpectWell(kOff, 10);
  int exchanges = 0;
  while (bench_.Exchange(kOn) == BusStatus::kOk && exchanges < 1000) ++exchanges;
  EXPECT_EQ(exchanges, 50);
  EXPECT_NE(Fault().find("is switched on but gets no supply, emergency message 0x"),
            std::string::npos)
      << Fault();
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk);
  SwitchOn();
}

TEST_P(DriveSupplies, AnotherEmergencyIsAFaultThoughTheDriveIsOff) {
  ExpectWell(kOff, 10);
  bench_.node(1).RaiseFault(0x2310);
  EXPECT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  EXPECT_EQ(Fault(), "can0: node 2 (drive2): emergency message 0x2310");
  for (int k = 0; k < 50; ++k) ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk) << "of its supply it reports while it is off";
  SwitchOn();
}

TEST_P(DriveSupplies, AFaultThatNoEmergencyExplainsIsOneThoughTheDriveIsOff) {
  Feed(true);
  ExpectWell(kOn, 45);
  ExpectWell(kOff, 10);
  bench_.node(1).Misbehave({.statusword = EncodeDriveState(DriveState::kFault)});
  int exchanges = 0;
  while (bench_.Exchange(kOff) == BusStatus::kOk && exchanges < 100) ++exchanges;
  EXPECT_EQ(exchanges, 2) << "its emergency could still come";
  EXPECT_EQ(bench_.device->fault().kind, CanopenFaultKind::kDriveFault);
}

// A simulated drive boots without DC link: it reports that during its configuration.
TEST_P(DriveSupplies, AConfigurationWithTheRelayOpenEndsWell) {
  bench_.node(0).PowerCycle();
  EXPECT_NE(bench_.Exchange(kOff), BusStatus::kOk);
  ASSERT_EQ(bench_.RecoverUntilOk(200), BusStatus::kOk);
  ExpectWell(kOff, 50);
  EXPECT_EQ(bench_.node(0).state(), DriveState::kFault);
  SwitchOn();
}

// Bit 4 of the statusword, in every state of the drive: also in the fault for want of supply.
TEST_P(DriveSupplies, TheVoltageIsReportedAsTheDcLinkHasIt) {
  ExpectVoltage(0, 0);
  ExpectWell(kOff, 3);
  ExpectVoltage(0, 0b11);
  Feed(true);
  ExpectWell(kOff, 10);
  ExpectVoltage(0, 0b11);  // it charges for 300 ms
  ExpectWell(kOff, 10);
  ExpectVoltage(0b11, 0);
  SwitchOn();
  ExpectVoltage(0b11, 0);
  ExpectWell(kOff, 3);
  Feed(false);
  ExpectWell(kOff, 2);
  ExpectVoltage(0, 0b11);
  bench_.node(1).Feed(true);
  ExpectWell(kOff, 20);
  ExpectVoltage(0b10, 0b01);
}

TEST_P(DriveSupplies, TheVoltageOfADriveThatDoesNotAnswerIsNotKnown) {
  ExpectWell(kOff, 3);
  bench_.node(0).Misbehave({.answers_no_sync = true});
  EXPECT_NE(bench_.Exchange(kOff), BusStatus::kOk);
  ExpectVoltage(0, 0b10);
}

}  // namespace
}  // namespace flexarm
