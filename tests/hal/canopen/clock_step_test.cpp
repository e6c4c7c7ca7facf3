#include <gtest/gtest.h>

#include "hal/canopen/arrival_clock.h"
#include "tests/hal/canopen/canopen_bench.h"

// The time of day, in which the kernel stamps frames, is set forward and back while the arm moves.

namespace flexarm {
namespace {

constexpr std::int64_t kHour = 3'600'000 * kMs;
constexpr BusCommand kMoving{.torque_nm = {9.0, 3.0}, .enabled = true};

// Instants of a period: each 50 us of its first 4 ms, of which an exchange takes 1 ms, and each ms
// of the rest.
std::vector<std::int64_t> Phases() {
  std::vector<std::int64_t> phases;
  for (std::int64_t t = 0; t < CanopenBench::kPeriod_ns; t += t < 4 * kMs ? kMs / 20 : kMs) {
    phases.push_back(t);
  }
  return phases;
}

class ClockStep : public testing::TestWithParam<std::int64_t> {};

INSTANTIATE_TEST_SUITE_P(Of, ClockStep,
                         testing::Values(kHour, -kHour, 1000 * kMs, -1000 * kMs, 26 * kMs,
                                         -26 * kMs));

TEST_P(ClockStep, CostsNoExchangeAtAnyPhase) {
  for (const std::int64_t phase_ns : Phases()) {
    CanopenBench bench;
    ASSERT_TRUE(bench.Enable(kMoving));
    bench.NextPeriod();
    bench.wire.AddClockStep(bench.now_ns() + CanopenBench::kPeriod_ns + phase_ns, GetParam());
    for (int k = 0; k < 10; ++k) {
      ASSERT_EQ(bench.Exchange(kMoving), BusStatus::kOk) << "phase " << phase_ns << " ns";
      EXPECT_LT(bench.now_ns() - bench.frame.sampled_at_ns, kMs) << "phase " << phase_ns << " ns";
      EXPECT_LE(bench.frame.sampled_at_ns, bench.now_ns()) << "phase " << phase_ns << " ns";
    }
    EXPECT_EQ(bench.device->counts().missed, 0U);
  }
}

class AnyClockStep : public testing::TestWithParam<std::int64_t> {};

INSTANTIATE_TEST_SUITE_P(Of, AnyClockStep,
                         testing::Values(kHour, -kHour, 100 * kMs, -100 * kMs, 10 * kMs, -10 * kMs,
                                         2 * kMs, -2 * kMs, kMs / 2, -kMs / 2));

// An encoder's answer that arrived 1 ms before it is read, before the SYNC was sent.
TEST_P(AnyClockStep, MakesNoStaleAnswerFresh) {
  for (const std::int64_t phase_ns : Phases()) {
    CanopenBench bench;
    ASSERT_TRUE(bench.Enable(kMoving));
    bench.NextPeriod();
    // Exchange 1 of those below begins after two periods; the step may come 2 ms before it.
    const std::int64_t first_ns = bench.now_ns() + 2 * CanopenBench::kPeriod_ns - 2 * kMs;
    bench.wire.AddClockStep(first_ns + phase_ns, GetParam());
    bool stale = false;
    bench.wire.SetTamper([&stale](const CanFrame* frame) {
      const bool of_hub = frame->id == CobId(kCobTpdo, 11);
      return MemoryWire::Fate{.waited_ns = stale && of_hub ? kMs : 0};
    });
    for (int k = 0; k < 4; ++k) {
      stale = k > 0;
      const BusStatus status = bench.Exchange(kMoving);
      if (stale) {
        EXPECT_NE(status, BusStatus::kOk) << "phase " << phase_ns << " ns, exchange " << k;
        EXPECT_EQ(bench.frame.counter_valid, 0U);
      }
    }
  }
}

// Steps of a few ms, of which a frame may lie on either side, may cost an exchange: never two.
TEST_P(AnyClockStep, CostsOneExchangeAtMost) {
  for (const std::int64_t phase_ns : Phases()) {
    CanopenBench bench;
    ASSERT_TRUE(bench.Enable(kMoving));
    bench.NextPeriod();
    bench.wire.AddClockStep(bench.now_ns() + CanopenBench::kPeriod_ns + phase_ns, GetParam());
    int lost = 0;
    for (int k = 0; k < 10; ++k) lost += bench.Exchange(kMoving) == BusStatus::kOk ? 0 : 1;
    EXPECT_LE(lost, 1) << "phase " << phase_ns << " ns";
    EXPECT_EQ(bench.device->fault().kind, CanopenFaultKind::kNone) << "phase " << phase_ns;
  }
}

TEST(ArrivalClock, AFrameArrivedWhenItsStampSays) {
  ArrivalClock clock;
  clock.Begin(0);
  for (std::int64_t t = kMs; t < 100 * kMs; t += kMs) {
    clock.Take({t, t + kHour, t});
    EXPECT_EQ(clock.ArrivalOf(t - kMs / 2 + kHour), t - kMs / 2);
  }
}

// It waits in the socket while the clock is set.
TEST(ArrivalClock, AFrameOfBeforeAStepThatIsReadAfterItArrivedWhenItDid) {
  for (const std::int64_t step_ns : {kHour, -kHour, 30 * kMs, -30 * kMs}) {
    ArrivalClock clock;
    clock.Begin(0);
    clock.Take({50 * kMs, 50 * kMs + kHour, 50 * kMs});
    clock.Emptied(50 * kMs);
    clock.Take({60 * kMs, 60 * kMs + kHour + step_ns, 60 * kMs});
    EXPECT_EQ(clock.ArrivalOf(55 * kMs + kHour), 55 * kMs) << "stamped before the step";
    EXPECT_EQ(clock.ArrivalOf(58 * kMs + kHour + step_ns), 58 * kMs) << "stamped after it";
  }
}

// The thread stands still between the readings of the clocks: that is no step.
TEST(ArrivalClock, AnInterruptionBetweenItsReadingsChangesNothing) {
  ArrivalClock clock;
  clock.Begin(0);
  clock.Take({kMs, kMs + kHour, kMs});
  clock.Take({2 * kMs, 10 * kMs + kHour, 10 * kMs});
  EXPECT_EQ(clock.ArrivalOf(kHour + 9 * kMs), 9 * kMs);
  clock.Take({11 * kMs, 11 * kMs + kHour, 20 * kMs});
  EXPECT_EQ(clock.ArrivalOf(kHour + 9 * kMs), 9 * kMs);
}

TEST(ArrivalClock, AnUnknownArrivalIsTheOldestPossible) {
  ArrivalClock clock;
  clock.Begin(0);
  clock.Take({50 * kMs, 50 * kMs + kHour, 50 * kMs});
  clock.Emptied(50 * kMs);
  clock.Take({60 * kMs, 60 * kMs + kHour, 60 * kMs});
  EXPECT_EQ(clock.ArrivalOf(0), 50 * kMs) << "no stamp";
  EXPECT_EQ(clock.ArrivalOf(70 * kMs + kHour), 50 * kMs - ArrivalClock::kInDelivery_ns)
      << "from the future";
  EXPECT_EQ(clock.ArrivalOf(1), 50 * kMs - ArrivalClock::kInDelivery_ns) << "from 1970";
}

}  // namespace
}  // namespace flexarm
