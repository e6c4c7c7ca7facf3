#include "hal/canopen/canopen_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "tests/hal/canopen/canopen_bench.h"
#include "tests/support/message_of.h"
#include "tests/support/no_alloc.h"

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr BusCommand kOn{.torque_nm = {}, .enabled = true};

std::string WhyNotOpened(CanopenBench* bench) {
  return MessageOf<HalError>([&] { bench->device->Open(); });
}

TEST(CanopenStartUp, SixNodesAreIdentifiedConfiguredAndOperational) {
  CanopenBench bench;
  ASSERT_EQ(WhyNotOpened(&bench), "");
  for (std::size_t i = 0; i < CanopenBench::kNodes; ++i) {
    EXPECT_EQ(bench.node(i).nmt(), NmtState::kOperational) << "node " << i;
    EXPECT_EQ(bench.node(i).Value(kObjectProducerHeartbeat), 50U);
    EXPECT_EQ(bench.node(i).Value({kObjectTpdoCommunication, 2}), kOnEverySync);
  }
  for (const std::size_t drive : {0U, 1U}) {
    SimulatedNode& node = bench.node(drive);
    EXPECT_EQ(node.Value(kObjectModeDisplay), kCyclicTorqueMode);
    EXPECT_EQ(node.Value(kObjectConsumerHeartbeat), 127U << 16U | 60U) << "pitfall 9";
    EXPECT_EQ(node.Value(kObjectAbortConnection), kDisableVoltageOnAbort);
    EXPECT_EQ(node.Value(kObjectMaxTorque), 1200U) << "36 N m of 0.03, 7.2 of 0.006";
    EXPECT_NE(node.Value({kObjectTpdoCommunication + 1, 1}) & kPdoDisabled, 0U)
        << "an unused PDO loads the bus";
    EXPECT_EQ(node.state(), DriveState::kSwitchOnDisabled) << "Open enables nothing";
  }
}

TEST(CanopenStartUp, TheBoundOfAnExchangeFollowsFromTheAnswerTime) {
  CanopenBench bench;
  EXPECT_EQ(bench.device->worst_case_ns(), 6 * kMs) << "5 ms of answers, 1 ms of computing";
  EXPECT_EQ(bench.device->drives(), 0b11U);
  EXPECT_STREQ(bench.device->name(), "can0");
}

// Each case: the fault, and the parts that the message must contain.
TEST(CanopenStartUp, AWrongNodeIsRejectedByNameWithFoundAndExpected) {
  struct Case {
    const char* what;
    std::size_t node;
    void (*spoil)(SimulatedNodeConfig*);
    std::array<const char*, 4> words;
  };
  const std::array cases = {
      Case{"vendor",
           1,
           [](SimulatedNodeConfig* n) { n->vendor = 0x999; },
           {"node 2 (drive2)", "1018:01", "found 2457 (0x999)", "expected 751 (0x2EF)"}},
      Case{"product",
           4,
           [](SimulatedNodeConfig* n) { n->product = 3; },
           {"node 13 (rotor1)", "1018:02", "found 3 (0x3)", "expected 88 (0x58)"}},
      Case{"an encoder in place of a drive",
           0,
           [](SimulatedNodeConfig* n) { n->drive = false; },
           {"node 1 (drive1)", "1000:00", "found 406", "expected 402"}},
      Case{"a motor of another size",
           0,
           [](SimulatedNodeConfig* n) { n->rated_torque_mnm = 5000; },
           {"node 1 (drive1)", "6076:00", "found 5000", "expected 6000"}},
      Case{"node id",
           3,
           [](SimulatedNodeConfig* n) { n->node_id = 99; },
           {"node 12 (hub2)", "boot-up message", "no answer", "can0"}},
  };
  for (const Case& c : cases) {
    std::vector<SimulatedNodeConfig> wired = CanopenBench::Wired(BenchConfig());
    c.spoil(&wired[c.node]);
    CanopenBench bench(BenchConfig(), wired);
    const std::string why = WhyNotOpened(&bench);
    for (const char* word : c.words) EXPECT_THAT(why, HasSubstr(word)) << c.what;
  }
}

TEST(CanopenStartUp, SwappedDrivesAreDistinguishedByTheirSerialNumbers) {
  CanopenConfig config = BenchConfig();
  config.node[0].serial = 8;
  CanopenBench bench(config);
  EXPECT_THAT(WhyNotOpened(&bench),
              AllOf(HasSubstr("node 1 (drive1)"), HasSubstr("1018:04"), HasSubstr("found 7")));
}

// A node that rejects or loses a setting on which the safety of the rig depends is not used.
TEST(CanopenStartUp, ANodeThatCannotBeConfiguredIsRejected) {
  struct Case {
    const char* what;
    std::size_t node;
    Misbehaviour wrong;
    std::array<const char*, 3> words;
  };
  const std::array cases = {
      Case{"mapping refused",
           0,
           {.refuses_index = kObjectRpdoMapping},
           {"node 1 (drive1)", "1600:00", "invalid value for parameter (0x06090030)"}},
      Case{"mapping not kept",
           1,
           {.forgets_index = kObjectTpdoMapping},
           {"node 2 (drive2)", "1A00:01", "found 0"}},
      Case{"encoder's mapping refused",
           2,
           {.refuses_index = kObjectTpdoMapping},
           {"node 11 (hub1)", "1A00:00", "refused"}},
      Case{"torque mode not kept",
           0,
           {.forgets_index = 0x6060},
           {"node 1 (drive1)", "6060:00", "expected 10"}},
      Case{"heartbeat producer not kept",
           5,
           {.forgets_index = 0x1017},
           {"node 14 (rotor2)", "1017:00", "found 0 (0x0), expected 50 (0x32)"}},
      Case{"heartbeat consumer refused",
           1,
           {.refuses_index = 0x1016},
           {"node 2 (drive2)", "1016:01", "refused"}},
      Case{"heartbeat consumer not kept",
           1,
           {.forgets_index = 0x1016},
           {"node 2 (drive2)", "1016:01", "found 0"}},
      Case{"keeps its torque when the link is lost",
           0,
           {.has_no_abort_option = true},
           {"node 1 (drive1)", "6007:00", "object does not exist"}},
      Case{"torque range not kept",
           0,
           {.forgets_index = 0x6072},
           {"node 1 (drive1)", "6072:00", "found 1000 (0x3E8), expected 1200 (0x4B0)"}},
      Case{"heartbeat configured, but not sent",
           4,
           {.no_heartbeat = true},
           {"node 13 (rotor1)", "operational", "no answer"}},
      Case{"dead", 3, {.silent = true}, {"node 12 (hub2)", "boot-up", "no answer"}},
  };
  for (const Case& c : cases) {
    CanopenBench bench;
    bench.node(c.node).Misbehave(c.wrong);
    const std::string why = WhyNotOpened(&bench);
    for (const char* word : c.words) EXPECT_THAT(why, HasSubstr(word)) << c.what;
    EXPECT_FALSE(bench.node(0).torque_per_mille() != 0);
  }
}

TEST(CanopenStartUp, DuplicatedOrUnrequestedAnswersDoNotDisturbTheStartUp) {
  CanopenBench bench;
  bench.wire.SetTamper([](CanFrame* frame) {
    return MemoryWire::Fate{.copies = (frame->id & 0x780) == kCobSdoReply ? 2 : 1};
  });
  bench.wire.AddRunner([&bench, next_ns = std::int64_t{0}]() mutable {
    if (bench.now_ns() < next_ns) return;
    next_ns = bench.now_ns() + kMs / 2;
    static_cast<void>(bench.spy.Send(SdoValueReply(1, {0x2222, 0}, 5, 4)));
  });
  EXPECT_EQ(WhyNotOpened(&bench), "");
}

TEST(CanopenStartUp, AnAnswerFromBeforeTheRequestIsIgnored) {
  CanopenBench bench;
  bench.wire.SetTamper([](CanFrame* frame) {
    return MemoryWire::Fate{.waited_ns = frame->id == CobId(kCobSdoReply, 2) ? kMs : 0};
  });
  EXPECT_THAT(WhyNotOpened(&bench), AllOf(HasSubstr("node 2 (drive2)"), HasSubstr("no answer")));
}

// NMT's reset of communication, not of the node: an incremental encoder would count from 0 again.
TEST(CanopenStartUp, AnEncoderKeepsItsCount) {
  CanopenBench bench;
  bench.node(2).SetPosition(777);
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(CanopenBench::kOff), BusStatus::kOk);
  EXPECT_EQ(bench.frame.counter[0], 777U);
}

TEST(CanopenStartUp, AFailedStartCanBeRepeated) {
  CanopenBench bench;
  bench.node(1).Misbehave({.silent = true});
  EXPECT_NE(WhyNotOpened(&bench), "");
  bench.node(1).Misbehave({});
  EXPECT_EQ(WhyNotOpened(&bench), "");
}

TEST(CanopenExchange, CountersAreRawAndSampledAtTheSync) {
  CanopenBench bench;
  bench.device->Open();
  const std::array<std::uint32_t, 4> counts = {5, 0xFFFFFFFF, 0x80000000, 12345678};
  for (std::size_t i = 0; i < 4; ++i) bench.node(2 + i).SetPosition(counts[i]);
  bench.Heard();
  ASSERT_EQ(bench.Exchange(CanopenBench::kOff), BusStatus::kOk);
  EXPECT_EQ(bench.frame.counter, counts);
  EXPECT_EQ(bench.frame.counter_valid, 0b1111U);
  EXPECT_EQ(bench.frame.strain_valid, 0U);
  EXPECT_EQ(bench.frame.counter_offset_ns, (std::array<std::int32_t, 4>{}));
  for (const ReceivedFrame& heard : bench.Heard()) {
    if (heard.frame.id != kCobSync) continue;
    EXPECT_EQ(bench.frame.sampled_at_ns, heard.at_ns);
  }
}

TEST(CanopenExchange, ADriveMayProvideTheCounterOfItsRotor) {
  CanopenConfig config = BenchConfig();
  config.node.resize(4);
  config.node[1].position_is_rotor = true;
  ASSERT_TRUE(config.Problems("").empty());
  CanopenBench bench(config);
  bench.device->Open();
  bench.node(1).SetPosition(static_cast<std::uint32_t>(-77));
  ASSERT_EQ(bench.Exchange(CanopenBench::kOff), BusStatus::kOk);
  EXPECT_EQ(bench.frame.counter_valid, 0b1011U);
  EXPECT_EQ(bench.frame.counter[3], static_cast<std::uint32_t>(-77));
}

// 0.1 % of rated torque is 0.03 and 0.006 N m at the gearbox's output; drive 2 is mounted with the
// opposite sign; the ranges are 1200 per mille. Rounded to the nearest.
TEST(CanopenExchange, TorqueIsPerMilleOfRatedWithSignAndRange) {
  CanopenBench bench;
  ASSERT_TRUE(bench.Enable());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  struct Case {
    double torque1_nm, torque2_nm;
    int per_mille1, per_mille2;
  };
  for (const Case& c :
       {Case{3.0, 0.6, 100, -100}, Case{-0.044, -0.0091, -1, 2}, Case{1e9, 1e9, 1200, -1200},
        Case{-40.0, -8.0, -1200, 1200}, Case{nan, 0.6, 0, -100}, Case{infinite, -infinite, 0, 0},
        Case{0.0, 0.0, 0, 0}}) {
    ASSERT_EQ(bench.Exchange({.torque_nm = {c.torque1_nm, c.torque2_nm}, .enabled = true}),
              BusStatus::kOk);
    EXPECT_EQ(bench.node(0).torque_per_mille(), c.per_mille1) << c.torque1_nm;
    EXPECT_EQ(bench.node(1).torque_per_mille(), c.per_mille2) << c.torque2_nm;
  }
  ASSERT_EQ(bench.Exchange({.torque_nm = {3.0, 0.6}, .enabled = true}), BusStatus::kOk);
  EXPECT_DOUBLE_EQ(bench.device->drive_torque_nm(0), 3.0);
  EXPECT_DOUBLE_EQ(bench.device->drive_torque_nm(1), 0.6);
}

TEST(CanopenExchange, ADriveIsEnabledOnlyWhileCommanded) {
  CanopenBench bench;
  bench.device->Open();
  for (int k = 0; k < 20; ++k) {
    ASSERT_EQ(bench.Exchange({.torque_nm = {9.0, 3.0}, .enabled = false}), BusStatus::kOk);
    ASSERT_EQ(bench.node(0).state(), DriveState::kSwitchOnDisabled);
  }
  ASSERT_TRUE(bench.EnableOpened({.torque_nm = {9.0, 3.0}, .enabled = true}));
  EXPECT_EQ(bench.node(0).torque_per_mille(), 300);
  // One exchange later the torque is off, for any commanded torque.
  ASSERT_EQ(bench.Exchange({.torque_nm = {9.0, 3.0}, .enabled = false}), BusStatus::kOk);
  EXPECT_EQ(bench.node(0).state(), DriveState::kSwitchOnDisabled);
  EXPECT_EQ(bench.node(0).torque_per_mille(), 0);
}

// The command is looked at just before its frame: a thread that stood still sends no old torque.
TEST(CanopenExchange, AnExpiredCommandCarriesNoTorque) {
  CanopenBench bench;
  ASSERT_TRUE(bench.Enable());
  bench.NextPeriod();
  const auto exchange = [&](std::int64_t expires_ns) {
    return bench.device->Exchange(
        {.torque_nm = {9.0, 3.0}, .enabled = true, .expires_ns = expires_ns}, &bench.frame);
  };
  ASSERT_EQ(exchange(bench.now_ns()), BusStatus::kOk);
  EXPECT_EQ(bench.node(0).torque_per_mille(), 300);
  bench.NextPeriod();
  ASSERT_EQ(exchange(bench.now_ns() - 1), BusStatus::kOk);
  EXPECT_EQ(bench.node(0).torque_per_mille(), 0);
  EXPECT_EQ(bench.node(1).torque_per_mille(), 0);
  EXPECT_EQ(bench.node(0).state(), DriveState::kOperationEnabled) << "only the torque";
}

TEST(CanopenExchange, SwitchOffActsBetweenTwoExchangesAndDisturbsNoReading) {
  CanopenBench bench;
  ASSERT_TRUE(bench.Enable());
  ASSERT_EQ(bench.Exchange({.torque_nm = {9.0, 3.0}, .enabled = true}), BusStatus::kOk);
  ASSERT_EQ(bench.node(0).torque_per_mille(), 300);
  const std::int64_t begin_ns = bench.now_ns();
  ASSERT_EQ(bench.device->SwitchOff(), BusStatus::kOk);
  EXPECT_EQ(bench.now_ns(), begin_ns) << "it waits for nothing";
  bench.wire.AdvanceTo(begin_ns + kMs / 2);  // two controlwords and a SYNC: 0.3 ms
  EXPECT_EQ(bench.node(0).torque_per_mille(), 0);
  EXPECT_EQ(bench.node(1).torque_per_mille(), 0);
  EXPECT_EQ(bench.node(0).state(), DriveState::kSwitchOnDisabled);
  for (int k = 0; k < 10; ++k) {
    ASSERT_EQ(bench.Exchange(CanopenBench::kOff), BusStatus::kOk);
    EXPECT_EQ(bench.frame.counter_valid, 0b1111U);
  }
  EXPECT_EQ(bench.device->counts().stale, 6U) << "the answers to the SYNC of SwitchOff";
  EXPECT_TRUE(bench.EnableOpened());
}

TEST(CanopenExchange, SwitchOffOfAFullQueueFails) {
  CanopenBench bench;
  EXPECT_EQ(bench.device->SwitchOff(), BusStatus::kOk) << "not open: there is nothing to do";
  ASSERT_TRUE(bench.Enable());
  bench.master->SetTransmitQueue(2);
  EXPECT_EQ(bench.device->SwitchOff(), BusStatus::kTimeout);
}

TEST(CanopenExchange, NoTorqueIsSentToADriveThatIsNotInOperation) {
  CanopenBench bench;
  bench.device->Open();
  bench.Heard();
  for (int k = 0; k < 3; ++k) {
    static_cast<void>(bench.Exchange({.torque_nm = {9.0, 3.0}, .enabled = true}));
  }
  for (const ReceivedFrame& heard : bench.Heard()) {
    if (heard.frame.id != CobId(kCobRpdo, 1)) continue;
    EXPECT_EQ(DecodeDriveCommand(heard.frame)->torque_per_mille, 0);
  }
}

TEST(CanopenExchange, TheExchangeTimeAndTheBusLoadAgreeWithTheComputedOnes) {
  CanopenBench bench;
  ASSERT_TRUE(bench.Enable());
  const CanopenConfig config = BenchConfig();
  std::int64_t longest_ns = 0, busy_ns = 0;
  bench.Heard();
  const std::int64_t begin_ns = bench.now_ns();
  for (int k = 0; k < 100; ++k) {
    bench.NextPeriod();
    const std::int64_t before_ns = bench.now_ns();
    ASSERT_EQ(bench.device->Exchange(kOn, &bench.frame), BusStatus::kOk);
    longest_ns = std::max(longest_ns, bench.now_ns() - before_ns);
    for (const ReceivedFrame& f : bench.Heard()) busy_ns += FrameTimeNs(f.frame.length, 1'000'000);
  }
  // The simulated nodes answer immediately, so the time on the wire alone is the bound.
  EXPECT_LE(longest_ns, config.wire_time_ns());
  EXPECT_GT(longest_ns, config.wire_time_ns() / 4) << "the bound must not be too wide";
  const double load = static_cast<double>(busy_ns) / static_cast<double>(bench.now_ns() - begin_ns);
  // 2 s contain 40 or 41 heartbeats of each node: that uncertainty is below 0.1 % of the bus.
  EXPECT_NEAR(load, config.bus_load(), 1e-3);
}

TEST(CanopenExchange, DoesNotAllocate) {
  if (!kNoAllocWorks) GTEST_SKIP() << "the sanitizers have their own allocator";
  CanopenBench bench;
  ASSERT_TRUE(bench.Enable());
  {
    const NoAlloc guard;
    for (int k = 0; k < 500; ++k) static_cast<void>(bench.Exchange(kOn));
    bench.node(1).RaiseFault(0x2310);
    for (int k = 0; k < 10; ++k) static_cast<void>(bench.Exchange(kOn));
    for (int k = 0; k < 10; ++k) static_cast<void>(bench.Recover());
    bench.node(2).Misbehave({.silent = true});
    for (int k = 0; k < 10; ++k) static_cast<void>(bench.Exchange(CanopenBench::kOff));
    bench.node(2).Misbehave({});
    for (int k = 0; k < 100; ++k) static_cast<void>(bench.Recover());
  }
  EXPECT_EQ(bench.Exchange(CanopenBench::kOff), BusStatus::kOk) << "the bus has recovered by then";
}

TEST(CanopenExchange, CloseSwitchesTheDrivesOff) {
  CanopenBench bench;
  ASSERT_TRUE(bench.Enable());
  ASSERT_EQ(bench.Exchange({.torque_nm = {9.0, 3.0}, .enabled = true}), BusStatus::kOk);
  ASSERT_NE(bench.node(1).torque_per_mille(), 0);
  // The master's end is closed with frames in its queue, which are still sent, as by a kernel.
  bench.Heard();
  bench.device->Close();
  bench.wire.AdvanceTo(bench.now_ns() + 5 * kMs);
  EXPECT_EQ(bench.node(0).torque_per_mille(), 0);
  EXPECT_EQ(bench.node(1).torque_per_mille(), 0);
  EXPECT_EQ(bench.node(1).nmt(), NmtState::kPreOperational);
  // The drives are switched off by their own state machine first, then by NMT.
  const std::vector<ReceivedFrame> heard = bench.Heard();
  EXPECT_TRUE(std::any_of(heard.begin(), heard.end(),
                          [](const ReceivedFrame& f) { return f.frame.id == kCobSync; }));
}

static_assert(noexcept(std::declval<CanopenDevice&>().Exchange({}, nullptr)));
static_assert(noexcept(std::declval<CanopenDevice&>().Reconnect()));

}  // namespace
}  // namespace flexarm
