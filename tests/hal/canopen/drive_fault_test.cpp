#include <gtest/gtest.h>

#include "tests/hal/canopen/canopen_bench.h"

// A fault of a drive that answers: it stays, with its name, until the operator acknowledges it.

namespace flexarm {
namespace {

class DriveFaults : public testing::Test {
 protected:
  static constexpr BusCommand kTorque{.torque_nm = {9.0, 3.0}, .enabled = true};
  static constexpr BusCommand kOff = CanopenBench::kOff;
  static constexpr BusCommand kAcknowledge = CanopenBench::kAcknowledge;

  void SetUp() override {
    ASSERT_TRUE(bench_.Enable(kTorque));
    bench_.Heard();
  }

  std::string Text() {
    return bench_.device->FaultText(bench_.device->FaultOf(BusStatus::kDriveFault));
  }

  // Fault resets that were sent to drive 1 since the last call.
  int Resets() {
    int resets = 0;
    for (const ReceivedFrame& heard : bench_.Heard()) {
      if (heard.frame.id != CobId(kCobRpdo, 1)) continue;
      resets += (DecodeDriveCommand(heard.frame)->controlword & kControlFaultReset) != 0 ? 1 : 0;
    }
    return resets;
  }

  CanopenBench bench_;
};

TEST_F(DriveFaults, AFaultStaysUntilItIsAcknowledged) {
  bench_.node(0).RaiseFault(0x2310);
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(bench_.Exchange(k < 50 ? kTorque : kOff), BusStatus::kDriveFault);
    EXPECT_EQ(Text(), "can0: node 1 (drive1): emergency message 0x2310");
    EXPECT_FALSE(bench_.device->needs_reconnect()) << "it answers";
    EXPECT_EQ(bench_.node(1).torque_per_mille(), 0) << "one drive's fault switches both off";
  }
  EXPECT_EQ(Resets(), 0);
  EXPECT_EQ(bench_.node(0).state(), DriveState::kFault);
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk);
  EXPECT_EQ(bench_.node(0).state(), DriveState::kSwitchOnDisabled);
  EXPECT_EQ(Resets(), 1);
  EXPECT_TRUE(bench_.EnableOpened());
}

TEST_F(DriveFaults, AReconnectDoesNotAcknowledge) {
  bench_.node(0).RaiseFault(0x2310);
  ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  for (int k = 0; k < 50; ++k) {
    bench_.NextPeriod();
    EXPECT_EQ(bench_.device->Reconnect(), BusStatus::kDriveFault);
  }
  EXPECT_EQ(Resets(), 0);
  EXPECT_EQ(bench_.node(0).state(), DriveState::kFault);
}

TEST_F(DriveFaults, WhileADriveIsInFaultTheEncodersAreRead) {
  bench_.node(0).RaiseFault(0x2310);
  bench_.node(2).SetPosition(41);
  ASSERT_EQ(bench_.Exchange(kTorque), BusStatus::kDriveFault);
  EXPECT_EQ(bench_.frame.counter_valid, 0b1111U);
  EXPECT_EQ(bench_.frame.counter[0], 41U);
}

TEST_F(DriveFaults, AcknowledgingWithoutAFaultChangesNothing) {
  for (int k = 0; k < 5; ++k) ASSERT_EQ(bench_.Exchange(kAcknowledge), BusStatus::kOk);
  EXPECT_EQ(Resets(), 0);
}

// A drive whose cause remains falls back into fault at each reset.
TEST_F(DriveFaults, AFaultWhoseCauseRemainsIsNotCleared) {
  bench_.node(0).RaiseFault(0x2310);
  ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  bench_.node(0).Misbehave({.statusword = EncodeDriveState(DriveState::kFault)});
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(bench_.Exchange(kAcknowledge), BusStatus::kDriveFault);
    EXPECT_EQ(Text(), "can0: node 1 (drive1): emergency message 0x2310") << "it keeps its name";
  }
  EXPECT_EQ(Resets(), 10) << "each second one is a rising edge";
  bench_.node(0).Misbehave({});
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk);
}

TEST_F(DriveFaults, AFaultThatComesWhileAcknowledgingIsNamed) {
  bench_.node(0).RaiseFault(0x2310);
  ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  bench_.node(1).RaiseFault(0x4210);
  EXPECT_EQ(bench_.Exchange(kAcknowledge), BusStatus::kDriveFault);
  EXPECT_EQ(Text(), "can0: node 2 (drive2): emergency message 0x4210");
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk);
}

TEST_F(DriveFaults, ADriveThatStaysInOperationIsNotCleared) {
  bench_.node(1).Misbehave({.statusword = EncodeDriveState(DriveState::kOperationEnabled)});
  BusStatus status = BusStatus::kOk;
  for (int k = 0; k < 10 && status == BusStatus::kOk; ++k) status = bench_.Exchange(kOff);
  ASSERT_EQ(bench_.device->fault().kind, CanopenFaultKind::kNotDisabled);
  for (int k = 0; k < 20; ++k) EXPECT_EQ(bench_.Exchange(kAcknowledge), BusStatus::kDriveFault);
  bench_.node(1).Misbehave({});
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk);
}

// The configuration resets the node and with it the fault: the operator still acknowledges it.
TEST_F(DriveFaults, AFaultOutlastsTheConfigurationOfTheNodes) {
  bench_.node(0).RaiseFault(0x2310);
  ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  bench_.node(0).Misbehave({.silent = true});
  for (int k = 0; k < 3; ++k) static_cast<void>(bench_.Exchange(kOff));
  ASSERT_TRUE(bench_.device->needs_reconnect());
  for (int k = 0; k < 60; ++k) static_cast<void>(bench_.Recover());
  EXPECT_EQ(Text(), "can0: node 1 (drive1): does not answer during its configuration, object");
  bench_.node(0).Misbehave({});
  for (int k = 0; k < 200 && bench_.device->needs_reconnect(); ++k) {
    static_cast<void>(bench_.Recover());
  }
  ASSERT_FALSE(bench_.device->needs_reconnect());
  for (int k = 0; k < 10; ++k) ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kDriveFault);
  EXPECT_EQ(Text(), "can0: node 1 (drive1): emergency message 0x2310");
  EXPECT_EQ(bench_.RecoverUntilOk(4), BusStatus::kOk);
  EXPECT_TRUE(bench_.EnableOpened());
}

}  // namespace
}  // namespace flexarm
