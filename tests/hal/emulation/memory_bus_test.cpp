#include "hal/emulation/memory_bus.h"

#include <gtest/gtest.h>

#include <array>

namespace flexarm {
namespace {

constexpr CanFrame Empty(std::uint32_t id) { return {.id = id, .length = 0}; }
constexpr std::int64_t kFrame_ns = 55'000;  // 55 bits at 1 Mbit/s

class Wire : public testing::Test {
 protected:
  void SetUp() override {
    const std::array<std::uint32_t, 3> ids = {1, 2, 3};
    sender_.Open(ids, 0);
    listener_.Open(ids, 0);
  }

  void Send(MemoryBus* bus, std::uint32_t id) {
    ASSERT_EQ(bus->Send(Empty(id)), SendResult::kSent);
  }

  MemoryWire wire_{1'000'000};
  MemoryBus sender_{&wire_}, listener_{&wire_};
  ReceivedFrame got_{};
};

TEST_F(Wire, AFrameTakesItsTimeAndReachesAllEndsAndItsSenderAsAnEcho) {
  Send(&sender_, 2);
  EXPECT_TRUE(sender_.unsent());
  wire_.AdvanceTo(kFrame_ns - 1);
  EXPECT_FALSE(listener_.Receive(&got_));
  wire_.AdvanceTo(kFrame_ns);
  ASSERT_TRUE(listener_.Receive(&got_));
  EXPECT_EQ(got_.at_ns, kFrame_ns);
  EXPECT_FALSE(got_.own);
  ASSERT_TRUE(sender_.Receive(&got_));
  EXPECT_TRUE(got_.own);
  EXPECT_FALSE(sender_.unsent());
}

TEST_F(Wire, TheLowestIdentifierIsSentFirstAndFramesDoNotOverlap) {
  Send(&listener_, 3);
  Send(&sender_, 1);
  wire_.AdvanceTo(3 * kFrame_ns);
  ASSERT_TRUE(listener_.Receive(&got_));
  EXPECT_EQ(got_.frame.id, 1U);
  ASSERT_TRUE(listener_.Receive(&got_));
  EXPECT_EQ(got_.frame.id, 3U);
  EXPECT_EQ(got_.at_ns, 2 * kFrame_ns);
}

TEST_F(Wire, OnlyTheRequestedIdentifiersAreReceived) {
  Send(&sender_, 7);
  wire_.AdvanceTo(2 * kFrame_ns);
  EXPECT_FALSE(listener_.Receive(&got_));
}

TEST_F(Wire, WaitingEndsWithAFrameOrAtItsInstant) {
  Send(&sender_, 1);
  listener_.WaitUntil(1'000'000);
  EXPECT_EQ(wire_.now_ns(), kFrame_ns);
  ASSERT_TRUE(listener_.Receive(&got_));
  listener_.WaitUntil(1'000'000);
  EXPECT_EQ(wire_.now_ns(), 1'000'000);
}

TEST_F(Wire, OnlySelectedFramesAreLostRepeatedDelayedOrChanged) {
  wire_.SetTamper([](CanFrame* frame) {
    if (frame->id == 1) return MemoryWire::Fate{.copies = 0};
    if (frame->id == 2) return MemoryWire::Fate{.copies = 2, .delay_ns = 5'000'000};
    frame->length = 1;
    return MemoryWire::Fate{};
  });
  for (const std::uint32_t id : {1U, 2U, 3U}) Send(&sender_, id);
  wire_.AdvanceTo(1'000'000);
  ASSERT_TRUE(listener_.Receive(&got_));
  EXPECT_EQ(got_.frame.id, 3U);
  EXPECT_EQ(got_.frame.length, 1);
  EXPECT_FALSE(listener_.Receive(&got_));
  wire_.AdvanceTo(10'000'000);
  for (int copy = 0; copy < 2; ++copy) {
    ASSERT_TRUE(listener_.Receive(&got_));
    EXPECT_EQ(got_.at_ns, 2 * kFrame_ns + 5'000'000);
  }
  EXPECT_FALSE(listener_.Receive(&got_));
}

TEST_F(Wire, AFullQueueRejectsAtOnceAndCounts) {
  wire_.SetStalled(true);
  for (std::size_t i = 0; i < MemoryBus::kTransmitQueue; ++i) Send(&sender_, 1);
  EXPECT_EQ(sender_.Send(Empty(1)), SendResult::kQueueFull);
  EXPECT_EQ(sender_.counts().queue_full, 1U);
  wire_.AdvanceTo(100'000'000);
  EXPECT_TRUE(sender_.unsent());
  EXPECT_FALSE(listener_.Receive(&got_));
  ASSERT_TRUE(sender_.Restart());
  wire_.SetStalled(false);
  wire_.AdvanceTo(200'000'000);
  EXPECT_FALSE(listener_.Receive(&got_)) << "queued frames are dropped";
}

TEST_F(Wire, AnEndInBusOffNeitherSendsNorReceivesUntilRestart) {
  listener_.SetBusOff();
  EXPECT_EQ(listener_.state(), CanState::kBusOff);
  EXPECT_EQ(listener_.Send(Empty(1)), SendResult::kQueueFull);
  Send(&sender_, 1);
  wire_.AdvanceTo(1'000'000);
  EXPECT_FALSE(listener_.Receive(&got_));
  listener_.SetRestartable(false);
  EXPECT_FALSE(listener_.Restart());
  EXPECT_EQ(listener_.state(), CanState::kBusOff);
  listener_.SetRestartable(true);
  EXPECT_TRUE(listener_.Restart());
  EXPECT_EQ(listener_.state(), CanState::kActive);
}

TEST_F(Wire, NodesRunOnTheGridAndAfterEachFrame) {
  int runs = 0;
  wire_.AddRunner([&runs] { ++runs; });
  wire_.AdvanceTo(1'000'000);
  EXPECT_EQ(runs, 10);
  Send(&sender_, 1);
  wire_.AdvanceTo(1'090'000);
  EXPECT_EQ(runs, 11);
}

}  // namespace
}  // namespace flexarm
