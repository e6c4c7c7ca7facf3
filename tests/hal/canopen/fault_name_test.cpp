#include <gtest/gtest.h>

#include "tests/hal/canopen/canopen_bench.h"

// Fault texts in the journal: each failed exchange has a name, with bus and node.

namespace flexarm {
namespace {

class CanopenFaultNames : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(bench_.Enable(kTorque)); }

  static constexpr BusCommand kTorque{.torque_nm = {3.0, 0.0}, .enabled = true};

  // One exchange, and its fault text.
  std::string After() {
    const BusStatus status = bench_.Exchange(kTorque);
    EXPECT_NE(status, BusStatus::kOk);
    return bench_.device->FaultText(bench_.device->FaultOf(status));
  }

  // Calls Reconnect until the text is this one; returns the last text.
  std::string Reconnecting(const std::string& until) {
    std::string text;
    for (int k = 0; k < 400 && text != until; ++k) {
      const BusStatus status = bench_.Recover();
      if (status == BusStatus::kOk) return "ok";
      text = bench_.device->FaultText(bench_.device->FaultOf(status));
    }
    return text;
  }

  CanopenBench bench_;
};

TEST_F(CanopenFaultNames, ASilentDriveIsNamedFromItsFirstMissedAnswerOn) {
  bench_.node(1).Misbehave({.silent = true});
  for (int k = 0; k < 5; ++k)
    EXPECT_EQ(After(), "can0: node 2 (drive2): does not answer SYNC") << k;
}

TEST_F(CanopenFaultNames, ALostHeartbeatIsNamed) {
  bench_.node(0).Misbehave({.no_heartbeat = true});
  BusStatus status = BusStatus::kOk;
  for (int k = 0; k < 20 && status == BusStatus::kOk; ++k) status = bench_.Exchange(kTorque);
  EXPECT_EQ(bench_.device->FaultText(bench_.device->FaultOf(status)),
            "can0: node 1 (drive1): heartbeat lost");
}

TEST_F(CanopenFaultNames, AMalformedPdoIsNamedWithItsSender) {
  bench_.node(3).Misbehave({.cuts_pdos = true});
  EXPECT_EQ(After(), "can0: node 12 (hub2): sends a malformed PDO");
}

TEST_F(CanopenFaultNames, AnEmergencyIsNamedWithItsCode) {
  bench_.node(0).RaiseFault(0x2310);
  EXPECT_EQ(After(), "can0: node 1 (drive1): emergency message 0x2310");
}

TEST_F(CanopenFaultNames, BusOffIsAFaultOfTheBus) {
  bench_.master->SetBusOff();
  EXPECT_EQ(After(), "can0: the CAN controller has left the bus (bus-off)");
}

// A failed drive is replaced by another product, which is rejected.
TEST_F(CanopenFaultNames, AnotherProductAtANodeIdIsRejectedByItsObject) {
  bench_.node(1).Misbehave({.silent = true});
  for (int k = 0; k < 3; ++k) static_cast<void>(After());
  const std::string absent =
      "can0: node 2 (drive2): does not answer during its configuration, object";
  EXPECT_EQ(Reconnecting(absent), absent);
  bench_.node(1).Misbehave({.another_product = true});
  const std::string refused = "can0: node 2 (drive2): does not match the config, object 0x1018";
  EXPECT_EQ(Reconnecting(refused), refused);
  bench_.node(1).Misbehave({});
  EXPECT_EQ(Reconnecting("ok"), "ok");
}

// Four bytes through the log and back.
TEST(CanopenFault, PacksAndUnpacks) {
  const CanopenFault fault{.kind = CanopenFaultKind::kSetupRefused, .node_id = 127, .code = 0xFFFF};
  const CanopenFault back = Unpacked(FaultFromBits(ToBits(Packed(fault))));
  EXPECT_EQ(back.kind, fault.kind);
  EXPECT_EQ(back.node_id, fault.node_id);
  EXPECT_EQ(back.code, fault.code);
  EXPECT_NE(fault.kind, static_cast<CanopenFaultKind>(kBusHangs));
}

}  // namespace
}  // namespace flexarm
