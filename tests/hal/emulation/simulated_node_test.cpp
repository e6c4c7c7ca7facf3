#include "hal/emulation/simulated_node.h"

#include <gtest/gtest.h>

#include "hal/emulation/memory_bus.h"
#include "tests/hal/canopen/canopen_bench.h"

namespace flexarm {
namespace {

// A drive with node id 5, tested frame by frame.
class SimulatedDrive : public testing::Test {
 protected:
  static constexpr int kId = 5;

  void SetUp() override {
    master_.OpenForAll();
    node_.Start();
    wire_.AddRunner([this] { node_.Run(); });
    Pass(kMs);
  }

  void Pass(std::int64_t time_ns) { wire_.AdvanceTo(wire_.now_ns() + time_ns); }
  void Send(const CanFrame& frame) {
    ASSERT_EQ(master_.Send(frame), SendResult::kSent);
    Pass(kMs);
  }
  // The last frame with this identifier; id 0 if there was none.
  CanFrame Last(std::uint32_t id) {
    ReceivedFrame received{};
    CanFrame last{};
    while (master_.Receive(&received)) {
      if (received.frame.id == id) last = received.frame;
    }
    return last;
  }
  SdoReply Reply() { return DecodeSdoReply(Last(CobId(kCobSdoReply, kId))); }
  SdoReply Write(CanopenObject object, std::uint32_t value, int size) {
    Send(SdoWriteRequest(kId, object, value, size));
    return Reply();
  }
  void Command(int control, std::int16_t torque) {
    Send(EncodeDriveCommand(
        kId, {.controlword = static_cast<std::uint16_t>(control), .torque_per_mille = torque}));
    Send(EncodeSync());
  }
  void Operate() {
    Write({kObjectRpdoCommunication, 1}, kPdoDisabled | 0x205, 4);
    Write({kObjectRpdoMapping, 1}, MappingEntry(kObjectControlword, 16), 4);
    Write({kObjectRpdoMapping, 2}, MappingEntry(kObjectTargetTorque, 16), 4);
    Write({kObjectRpdoMapping, 0}, 2, 1);
    Write({kObjectRpdoCommunication, 1}, 0x205, 4);
    Write(kObjectMode, kCyclicTorqueMode, 1);
    Send(EncodeNmt(NmtCommand::kStart, 0));
    for (const int control : {0x06, 0x07, 0x0F}) Command(control, 200);
  }

  MemoryWire wire_{1'000'000};
  MemoryBus master_{&wire_}, end_{&wire_};
  SimulatedNode node_{&end_,
                      {.drive = true,
                       .node_id = kId,
                       .vendor = 1,
                       .product = 2,
                       .serial = 3,
                       .rated_torque_mnm = 400}};
};

TEST_F(SimulatedDrive, SendsItsBootUpMessageAndItsIdentity) {
  EXPECT_EQ(Last(0x705), EncodeHeartbeat(kId, NmtState::kBooting));
  Send(SdoReadRequest(kId, kObjectVendor));
  EXPECT_EQ(Reply().value, 1U);
  Send(SdoReadRequest(kId, kObjectRatedTorque));
  EXPECT_EQ(Reply().value, 400U);
}

TEST_F(SimulatedDrive, RejectsTheRequestsThatARealDriveRejects) {
  EXPECT_EQ(Write({0x2000, 0}, 1, 1).value, kSdoAbortNoObject);
  EXPECT_EQ(Write(kObjectVendor, 1, 4).value, kSdoAbortReadOnly);
  EXPECT_EQ(Write(kObjectProducerHeartbeat, 50, 4).value, kSdoAbortWrongLength);
  EXPECT_EQ(Write({kObjectRpdoMapping, 1}, 0x60400010, 4).value, kSdoAbortDeviceState)
      << "the PDO is not off";
  Write({kObjectRpdoCommunication, 1}, kPdoDisabled | 0x205, 4);
  EXPECT_EQ(Write({kObjectRpdoMapping, 1}, 0x60400008, 4).kind, SdoReply::Kind::kWritten);
  EXPECT_EQ(Write({kObjectRpdoMapping, 0}, 1, 1).value, kSdoAbortNotMappable) << "8 of 16 bits";
}

TEST_F(SimulatedDrive, MakesTorqueOnlyInOperationAndActsAtTheSync) {
  Operate();
  EXPECT_EQ(node_.state(), DriveState::kOperationEnabled);
  EXPECT_EQ(node_.torque_per_mille(), 200);
  Send(EncodeDriveCommand(kId, {.controlword = 0x0F, .torque_per_mille = 300}));
  EXPECT_EQ(node_.torque_per_mille(), 200) << "not before SYNC";
  Send(EncodeSync());
  EXPECT_EQ(node_.torque_per_mille(), 300);
  Command(0x0F, 2000);
  EXPECT_EQ(node_.torque_per_mille(), 1000) << "default of 6072";
  Command(0x00, 300);
  EXPECT_EQ(node_.torque_per_mille(), 0);
  Command(0x0F, 300);
  EXPECT_EQ(node_.torque_per_mille(), 0) << "operation is reached only through all states";
}

TEST_F(SimulatedDrive, OnlyARisingResetBitLeavesAFault) {
  Operate();
  node_.RaiseFault(0x2310);
  EXPECT_EQ(node_.torque_per_mille(), 0);
  Pass(kMs);
  EXPECT_EQ(DecodeEmergency(Last(0x085))->code, 0x2310);
  for (const int control : {0x00, 0x06, 0x07, 0x0F}) Command(control, 100);
  EXPECT_EQ(node_.state(), DriveState::kFault);
  Command(0x80, 0);
  EXPECT_EQ(node_.state(), DriveState::kSwitchOnDisabled);
  node_.RaiseFault(0x2310);
  Command(0x80, 0);
  EXPECT_EQ(node_.state(), DriveState::kFault) << "no rising edge";
}

// 6007: 0 nothing, 1 fault, 2 disable voltage. The default is 0, and the torque stays.
TEST_F(SimulatedDrive, FollowsTheAbortOptionWhenTheMasterHeartbeatIsLost) {
  struct Case {
    std::uint32_t option;
    int torque;
    DriveState state;
  };
  for (const Case& c : {Case{0, 200, DriveState::kOperationEnabled}, Case{1, 0, DriveState::kFault},
                        Case{2, 0, DriveState::kSwitchOnDisabled}}) {
    Send(EncodeNmt(NmtCommand::kResetNode, kId));
    Write(kObjectConsumerHeartbeat, 127U << 16U | 40U, 4);
    Write(kObjectAbortConnection, c.option, 2);
    Operate();
    Send(EncodeHeartbeat(127, NmtState::kOperational));
    Pass(38 * kMs);
    EXPECT_EQ(node_.torque_per_mille(), 200) << c.option;
    Pass(3 * kMs);
    EXPECT_EQ(node_.torque_per_mille(), c.torque) << c.option;
    EXPECT_EQ(node_.state(), c.state);
    EXPECT_EQ(DecodeEmergency(Last(0x085))->code, 0x8130);
  }
}

TEST_F(SimulatedDrive, AHeartbeatOfAnotherNodeDoesNotCountAsTheMasters) {
  Write(kObjectConsumerHeartbeat, 127U << 16U | 40U, 4);
  Write(kObjectAbortConnection, 2, 2);
  Operate();
  Send(EncodeHeartbeat(127, NmtState::kOperational));
  for (int k = 0; k < 10; ++k) Send(EncodeHeartbeat(126, NmtState::kOperational));
  Pass(32 * kMs);
  EXPECT_EQ(node_.torque_per_mille(), 0);
}

TEST_F(SimulatedDrive, SendsHeartbeatsAtItsProducerTime) {
  Write(kObjectProducerHeartbeat, 10, 2);
  Last(0x705);
  Pass(100 * kMs);
  int count = 0;
  ReceivedFrame received{};
  while (master_.Receive(&received)) count += received.frame.id == 0x705 ? 1 : 0;
  EXPECT_NEAR(count, 10, 1);
}

}  // namespace
}  // namespace flexarm
