#include <gtest/gtest.h>

#include "tests/hal/canopen/canopen_bench.h"

// Nodes that were lost: the pause between configurations, and counters that lost their count.

namespace flexarm {
namespace {

class LostNodes : public testing::Test {
 protected:
  static constexpr BusCommand kOff = CanopenBench::kOff;

  void SetUp() override { ASSERT_TRUE(bench_.Enable()); }

  void Lose(std::size_t node) {
    bench_.node(node).Misbehave({.silent = true});
    for (int k = 0; k < 4; ++k) static_cast<void>(bench_.Exchange(kOff));
    ASSERT_TRUE(bench_.device->needs_reconnect());
    bench_.Heard();
  }

  // Instants at which the setup has reset node `id`, within `duration_ns`.
  std::vector<std::int64_t> Attempts(int id, std::int64_t duration_ns) {
    std::vector<std::int64_t> attempts;
    for (const std::int64_t end_ns = bench_.now_ns() + duration_ns; bench_.now_ns() < end_ns;) {
      static_cast<void>(bench_.Recover());
      for (const ReceivedFrame& heard : bench_.Heard()) {
        const auto order = heard.frame.id == kCobNmt ? DecodeNmt(heard.frame) : std::nullopt;
        if (order && order->node_id == id && order->command == NmtCommand::kResetNode) {
          attempts.push_back(heard.at_ns);
        }
      }
    }
    return attempts;
  }

  CountEpochs epochs() { return bench_.device->count_epochs(); }

  CanopenBench bench_;
};

// boot_timeout_ms is 500, then the pause: 0.1, 0.2, 0.4, 0.8, 1.6, 2, 2 .. s.
TEST_F(LostNodes, EachFailedConfigurationDoublesThePauseBeforeTheNext) {
  Lose(0);
  const std::vector<std::int64_t> attempts = Attempts(1, 20'000 * kMs);
  ASSERT_GE(attempts.size(), 8U);
  const std::vector<double> pauses_s = {0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0};
  for (std::size_t i = 0; i < pauses_s.size(); ++i) {
    const double between_s = static_cast<double>(attempts[i + 1] - attempts[i]) * 1e-9;
    EXPECT_NEAR(between_s, 0.5 + pauses_s[i], 0.05) << i;
  }
  bench_.node(0).Misbehave({});
  EXPECT_EQ(bench_.RecoverUntilOk(150), BusStatus::kOk) << "within the pause";
}

TEST_F(LostNodes, AfterTwoGoodSecondsTheFirstPauseIsShortAgain) {
  Lose(0);
  static_cast<void>(Attempts(1, 5'000 * kMs));
  bench_.node(0).Misbehave({});
  ASSERT_EQ(bench_.RecoverUntilOk(200), BusStatus::kOk);
  for (int k = 0; k < 250; ++k) ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kOk);
  Lose(0);
  const std::vector<std::int64_t> attempts = Attempts(1, 2'000 * kMs);
  ASSERT_GE(attempts.size(), 2U);
  EXPECT_NEAR(static_cast<double>(attempts[1] - attempts[0]) * 1e-9, 0.6, 0.05);
}

// A bus whose configuration succeeds, and which fails at once again.
TEST_F(LostNodes, ANodeThatFailsAgainAndAgainIsNotResetWithoutPause) {
  std::vector<std::int64_t> all;
  for (int k = 0; k < 8; ++k) {
    Lose(0);
    bench_.node(0).Misbehave({});
    while (bench_.device->needs_reconnect()) {
      const std::vector<std::int64_t> attempts = Attempts(1, 20 * kMs);
      all.insert(all.end(), attempts.begin(), attempts.end());
    }
  }
  ASSERT_EQ(all.size(), 8U);
  EXPECT_GE(all.back() - all.front(), 5'000 * kMs);
}

TEST_F(LostNodes, NoCountIsLostWhileAllIsWell) {
  for (int k = 0; k < 100; ++k) ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kOk);
  EXPECT_EQ(epochs(), CountEpochs{});
}

TEST_F(LostNodes, ABootUpMessageIsALostCountOfThatNode) {
  bench_.node(3).SetPosition(777);
  bench_.node(3).PowerCycle();
  EXPECT_NE(bench_.Exchange(kOff), BusStatus::kOk);
  EXPECT_EQ(epochs(), (CountEpochs{0, 1, 0, 0}));
  ASSERT_EQ(bench_.RecoverUntilOk(100), BusStatus::kOk);
  ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kOk);
  EXPECT_EQ(bench_.frame.counter[1], 0U) << "it counts from where it stood";
  bench_.node(3).SetPosition(787);
  ASSERT_EQ(bench_.Exchange(kOff), BusStatus::kOk);
  EXPECT_EQ(bench_.frame.counter[1], 10U);
}

TEST_F(LostNodes, AConfigurationIsALostCountOfEachNode) {
  Lose(0);
  bench_.node(0).Misbehave({});
  ASSERT_EQ(bench_.RecoverUntilOk(100), BusStatus::kOk);
  for (const std::uint32_t epoch : epochs()) EXPECT_EQ(epoch, 1U);
}

TEST(LostNodesOf, ADriveThatCountsItsRotorLosesItsCount) {
  CanopenConfig config = BenchConfig();
  config.node[1].position_is_rotor = true;
  config.node.pop_back();
  CanopenBench bench(config, CanopenBench::Wired(config));
  ASSERT_TRUE(bench.Enable());
  bench.node(1).PowerCycle();
  EXPECT_NE(bench.Exchange(CanopenBench::kOff), BusStatus::kOk);
  EXPECT_EQ(bench.device->count_epochs(), (CountEpochs{0, 0, 0, 1}));
}

// It says that it cannot be trusted: no operator can repair its count by acknowledging it.
TEST_F(LostNodes, AnEncoderWithAnEmergencyIsConfiguredAgain) {
  bench_.node(2).RaiseFault(0x5000);
  EXPECT_EQ(bench_.Exchange(kOff), BusStatus::kDisconnected);
  EXPECT_TRUE(bench_.device->needs_reconnect());
  EXPECT_EQ(bench_.frame.counter_valid, 0U);
  ASSERT_EQ(bench_.RecoverUntilOk(100), BusStatus::kOk);
  EXPECT_EQ(epochs()[0], 1U);
}

}  // namespace
}  // namespace flexarm
