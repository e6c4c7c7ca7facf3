#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <set>
#include <utility>

#include "hal/canopen/confirmed_bus.h"
#include "tests/hal/canopen/canopen_bench.h"

// A CAN controller accepts eight frames and holds them while no node acknowledges. The kernel does
// not count them.

namespace flexarm {
namespace {

constexpr std::size_t kHeld = 8;
constexpr std::int64_t kPermit_ns = 5 * kMs;  // safety.permit_timeout_ms of the shipped rigs

int TorqueOf(const ReceivedFrame& heard) {
  for (const int drive : {1, 2}) {
    if (heard.frame.id != CobId(kCobRpdo, drive)) continue;
    const auto command = DecodeDriveCommand(heard.frame);
    return command ? command->torque_per_mille : 0;
  }
  return 0;
}

// An arm in motion whose bus is cut. Each exchange has a torque of its own, 1, 2, .. per mille.
class Cut {
 public:
  Cut() {
    bench.master->SetControllerQueue(kHeld);
    EXPECT_TRUE(bench.Enable());
    for (int k = 0; k < 5; ++k) EXPECT_EQ(Exchange(), BusStatus::kOk);
  }

  BusStatus Exchange() {
    bench.NextPeriod();
    ++exchange_;
    return bench.device->Exchange({.torque_nm = {0.03 * exchange_, 0.006 * exchange_},
                                   .enabled = true,
                                   .expires_ns = bench.now_ns() + kPermit_ns},
                                  &bench.frame);
  }

  // No node acknowledges from `at_ns` on.
  void CutAt(std::int64_t at_ns) {
    bench.wire.AddRunner([this, at_ns] {
      if (bench.now_ns() >= at_ns && !mended_) bench.wire.SetStalled(true);
    });
  }
  void Mend() {
    mended_ = true;
    bench.Heard();
    bench.wire.SetStalled(false);
  }

  // The torques on the wire since the last call. Those of both drives are equal.
  std::set<int> Torques() {
    std::set<int> torques;
    for (const ReceivedFrame& heard : bench.Heard()) {
      if (const int torque = std::abs(TorqueOf(heard)); torque != 0) torques.insert(torque);
    }
    return torques;
  }

  CanopenBench bench;

 private:
  int exchange_ = 0;
  bool mended_ = false;
};

// The plug is pulled at every phase of a period and within an exchange, the arm stays armed for
// `periods` more, and the plug is put in again: all that comes out is old.
TEST(ControllerQueue, HoldsTheTorqueOfOneExchangeAtMost) {
  std::size_t most = 0;
  for (std::int64_t phase_ns = 0; phase_ns < 20 * kMs;
       phase_ns += phase_ns < 2 * kMs ? kMs / 10 : kMs) {
    for (const int periods : {1, 2, 3, 6, 20}) {
      Cut cut;
      cut.CutAt(cut.bench.now_ns() / CanopenBench::kPeriod_ns * CanopenBench::kPeriod_ns +
                CanopenBench::kPeriod_ns + phase_ns);
      for (int k = 0; k < periods + 1; ++k) static_cast<void>(cut.Exchange());
      cut.bench.wire.AdvanceTo(cut.bench.now_ns() + kPermit_ns);
      cut.Mend();
      cut.bench.wire.AdvanceTo(cut.bench.now_ns() + 10 * kMs);
      const std::set<int> torques = cut.Torques();
      EXPECT_LE(torques.size(), 1U) << "phase " << phase_ns << " ns, " << periods << " periods";
      most = std::max(most, torques.size());
    }
  }
  EXPECT_EQ(most, 1U) << "the one in flight, so that the test can find more";
}

TEST(ControllerQueue, IsEmptiedBeforeTheBusIsUsedAgain) {
  Cut cut;
  cut.CutAt(cut.bench.now_ns());
  for (int k = 0; k < 3; ++k) EXPECT_NE(cut.Exchange(), BusStatus::kOk);
  EXPECT_FALSE(cut.bench.master->unsent()) << "the kernel counts none of them";
  EXPECT_EQ(cut.bench.device->fault().kind, CanopenFaultKind::kTransmitStuck);
  EXPECT_EQ(cut.bench.Recover(), BusStatus::kTimeout) << "restarts the interface";
  cut.Mend();
  EXPECT_EQ(cut.bench.RecoverUntilOk(100), BusStatus::kOk);
  EXPECT_EQ(cut.Torques(), std::set<int>{});
  EXPECT_TRUE(cut.bench.EnableOpened());
}

// An adapter without the right to restart it: what it held is out, and it is used again.
TEST(ControllerQueue, ThatHasBecomeEmptyByItselfNeedsNoRestart) {
  Cut cut;
  cut.bench.master->SetRestartable(false);
  cut.CutAt(cut.bench.now_ns());
  for (int k = 0; k < 3; ++k) EXPECT_NE(cut.Exchange(), BusStatus::kOk);
  cut.Mend();
  EXPECT_EQ(cut.bench.RecoverUntilOk(100), BusStatus::kOk);
}

// The echo of a frame from before a restart, read after it, does not stand for a frame of now.
TEST(ConfirmedBusTest, AnEchoFromBeforeARestartConfirmsNothing) {
  MemoryWire wire(1'000'000);
  auto end = std::make_unique<MemoryBus>(&wire);
  end->SetControllerQueue(kHeld);
  ConfirmedBus bus(std::move(end));
  const std::array<std::uint32_t, 1> ids = {kCobSync};
  bus.Open(ids, 1'000'000);
  ASSERT_EQ(bus.Send(EncodeSync()), SendResult::kSent);
  EXPECT_TRUE(bus.unsent());
  wire.AdvanceTo(kMs);
  EXPECT_TRUE(bus.unsent()) << "its echo has not been read";
  ASSERT_TRUE(bus.Restart());
  EXPECT_FALSE(bus.unsent());
  wire.SetStalled(true);
  wire.AdvanceTo(2 * kMs);
  ASSERT_EQ(bus.Send(EncodeSync()), SendResult::kSent);
  ReceivedFrame received{};
  ASSERT_TRUE(bus.Receive(&received));
  EXPECT_TRUE(received.own);
  EXPECT_TRUE(bus.unsent());
  wire.SetStalled(false);
  wire.AdvanceTo(3 * kMs);
  ASSERT_TRUE(bus.Receive(&received));
  EXPECT_FALSE(bus.unsent());
}

TEST(ControllerQueue, ASwitchOffComesAfterWhatItHolds) {
  Cut cut;
  cut.CutAt(cut.bench.now_ns());
  EXPECT_NE(cut.Exchange(), BusStatus::kOk);
  EXPECT_EQ(cut.bench.device->SwitchOff(), BusStatus::kOk);
  cut.Mend();
  cut.bench.wire.AdvanceTo(cut.bench.now_ns() + 2 * kMs);
  EXPECT_EQ(cut.bench.node(0).torque_per_mille(), 0);
  EXPECT_EQ(cut.bench.node(0).state(), DriveState::kSwitchOnDisabled);
}

}  // namespace
}  // namespace flexarm
