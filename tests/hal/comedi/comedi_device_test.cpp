#include "hal/comedi/comedi_device.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "tests/hal/comedi/comedi_bench.h"
#include "tests/support/no_alloc.h"

// The driver against a simulated board, in virtual time. Codes and volts are computed by hand.

namespace flexarm {
namespace {

constexpr double kStepV = 20.0 / 4096.0;
// Half a step of rounding, and up to one between our steps (0 V is 2^(n-1), a step 20 V / 2^n) and
// the amplifier's, which are read by comedi's rule (10 V is 2^n - 1).
constexpr double kOutputToleranceV = 1.5 * kStepV;

BusCommand Torque(double first_nm, double second_nm) {
  return {.torque_nm = {first_nm, second_nm}, .enabled = true};
}

TEST(ComediDevice, ReadsEveryChannelOfTheConfig) {
  ComediBench bench;
  bench.board->SetVoltage([](int channel, std::int64_t) { return 0.5 * channel - 4.0; });
  bench.board->counter = {111, 0, 0xFFFFFF, 0};
  bench.board->lines = 0b001000;
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
  const SensorFrame& frame = bench.frame;
  EXPECT_EQ(frame.strain_valid, 0x3FFU);
  EXPECT_EQ(frame.strain[0], std::lround(3.5 / kStepV));   // channel 15: 717
  EXPECT_EQ(frame.strain[9], std::lround(-1.0 / kStepV));  // channel 6: -205
  EXPECT_EQ(frame.counter_valid, 0b0011U);
  EXPECT_EQ(frame.counter[0], 0xFFFFFFU);  // hub1 is channel 2
  EXPECT_EQ(frame.counter[1], 111U);
  EXPECT_EQ(frame.levels, LineBit(Line::kResetButton));
}

TEST(ComediDevice, TakesTheNewestCompleteScan) {
  ComediBench bench;
  bench.device->Open();
  bench.board->SetVoltage([&](int, std::int64_t at_ns) {
    return static_cast<double>(at_ns - 1'000 * kMillisecond) / 1e9;  // a volt a second
  });
  for (int k = 0; k < 50; ++k) {
    ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
    const double seconds = bench.frame.strain[9] * kStepV;
    const double now_s = static_cast<double>(bench.board->now_ns() - 1'000 * kMillisecond) / 1e9;
    // An interval, a scan, and the exchange's own 0.1 ms; half a step is 2.4 ms.
    EXPECT_LT(now_s - seconds, 1.6e-3 + kStepV / 2) << k;
  }
}

// The voltage is proportional to time: 20 V in 20 ms. So the true instant of a reading can be
// compared with the instant in its frame.
class ComediStamps : public testing::Test {
 protected:
  static ComediBoardConfig Fine(ComediBoardConfig config) {
    config.input->bits = 16;
    return config;
  }
  static SimulatedDaqConfig FineBoard(std::int64_t transfer_ns) {
    return {.input_bits = 16, .transfer_ns = transfer_ns};
  }
  static void ShowTime(ComediBench* bench) {
    bench->board->SetVoltage([](int, std::int64_t at_ns) {
      return static_cast<double>(at_ns % (20 * kMillisecond)) / 1e6 - 10.0;
    });
  }
  // Difference of the true instant of the reading and the instant in its frame.
  static double Error_ns(const SensorFrame& frame, std::size_t channel) {
    const std::int64_t said_ns = frame.sampled_at_ns + frame.strain_offset_ns[channel];
    const double shown_ns = (frame.strain[channel] + 32768) / 65536.0 * 20e6;
    return std::remainder(shown_ns - static_cast<double>(said_ns % (20 * kMillisecond)), 20e6);
  }
};

TEST_F(ComediStamps, AStreamedReadingHasTheAgeOfItsOffset) {
  for (const std::int64_t transfer_ns : {0, 100'000, 200'000}) {
    for (const std::int64_t phase_ns : {0, 250'000, 500'000, 750'000, 999'000}) {
      ComediBench bench(Fine(BenchBoard()), FineBoard(transfer_ns));
      ShowTime(&bench);
      bench.board->AdvanceTo(bench.board->now_ns() + phase_ns);  // the scan begins there
      bench.device->Open();
      for (int k = 0; k < 100; ++k) {
        ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
        for (std::size_t i = 0; i < 10; ++i) {
          // ScanClock's bound: half of interval, transfer and reading.
          EXPECT_LE(std::abs(Error_ns(bench.frame, i)), 605'000.0) << phase_ns << " " << k;
        }
      }
    }
  }
}

TEST_F(ComediStamps, TheOffsetsContainTheSkewOfTheChannels) {
  ComediBench bench(Fine(BenchBoard()), FineBoard(0));
  ShowTime(&bench);
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_EQ(bench.frame.strain_offset_ns[i] - bench.frame.strain_offset_ns[i - 1], 50'000);
    EXPECT_NEAR(Error_ns(bench.frame, i), Error_ns(bench.frame, 0), 500.0);  // one step: 0.3 us
  }
}

TEST_F(ComediStamps, SimultaneousInputsHaveOneInstant) {
  ComediBoardConfig config = Fine(BenchBoard());
  config.input->convert_interval_us = 0.0;
  ComediBench bench(config, FineBoard(0));
  ShowTime(&bench);
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_EQ(bench.frame.strain_offset_ns[i], bench.frame.strain_offset_ns[0]);
    EXPECT_EQ(bench.frame.strain[i], bench.frame.strain[0]);
  }
}

TEST_F(ComediStamps, AFastOrSlowClockOfTheBoardIsTracked) {
  for (const double pace : {0.9999, 1.0001}) {  // 100 ppm: 20 ms in 200 s
    ComediBench bench(Fine(BenchBoard()), FineBoard(0));
    ShowTime(&bench);
    bench.board->pace = pace;
    bench.device->Open();
    for (int k = 0; k < 10'000; ++k) {
      ASSERT_EQ(bench.Exchange(), BusStatus::kOk) << k;
      // ScanClock's bound: half of interval, transfer and reading, and 0.13 ms of drift.
      ASSERT_LE(std::abs(Error_ns(bench.frame, 0)), 605'000.0 + 130'000.0) << k;
    }
  }
}

TEST_F(ComediStamps, ASingleReadingHasTheInstantOfItsMiddle) {
  ComediBench bench(Fine(SingleReads()), FineBoard(0));
  ShowTime(&bench);
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_NEAR(Error_ns(bench.frame, i), 0.0, 500.0) << i;  // a step: 0.3 us
  }
  EXPECT_EQ(bench.frame.strain_offset_ns[0], 7'500);
  EXPECT_EQ(bench.frame.strain_offset_ns[9], 9 * 15'000 + 7'500);
  EXPECT_EQ(bench.frame.counter_offset_ns[0], 10 * 15'000 + 7'500);
}

TEST(ComediDevice, VoltsAreTorqueOverTorquePerVoltAndGear) {
  ComediBench bench;
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(Torque(20.0, 3.0)), BusStatus::kOk);
  // 0.8 N m per volt at the motor, gear 5: 4 N m per volt. 0.02 and 50: 1, with sign -1.
  EXPECT_NEAR(bench.board->output_v(1), 5.0, kOutputToleranceV);
  EXPECT_NEAR(bench.board->output_v(0), -3.0, kOutputToleranceV);
  EXPECT_EQ(bench.device->drives(), 0b11U);
}

TEST(ComediDevice, ATorqueBeyondTheRangeIsClippedAndNanIsZero) {
  ComediBench bench;
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(Torque(1000.0, -1000.0)), BusStatus::kOk);
  EXPECT_NEAR(bench.board->output_v(1), 9.0, kOutputToleranceV);  // 36 N m
  EXPECT_NEAR(bench.board->output_v(0), 7.0, kOutputToleranceV);  // 7 N m
  const double no_number = std::numeric_limits<double>::quiet_NaN();
  ASSERT_EQ(bench.Exchange(Torque(no_number, no_number)), BusStatus::kOk);
  EXPECT_NEAR(bench.board->output_v(1), 0.0, kOutputToleranceV);
  EXPECT_NEAR(bench.board->output_v(0), 0.0, kOutputToleranceV);
}

TEST(ComediDevice, WithoutPermissionTheVoltageIsZero) {
  ComediBench bench;
  bench.device->Open();
  EXPECT_NEAR(bench.board->output_v(1), 0.0, kOutputToleranceV);  // it was -10 V before Open
  ASSERT_EQ(bench.Exchange(Torque(20.0, 3.0)), BusStatus::kOk);
  ASSERT_EQ(bench.Exchange({.torque_nm = {20.0, 3.0}, .enabled = false}), BusStatus::kOk);
  EXPECT_NEAR(bench.board->output_v(1), 0.0, kOutputToleranceV);
  EXPECT_NEAR(bench.board->output_v(0), 0.0, kOutputToleranceV);
}

TEST(ComediDevice, AnExpiredCommandIsZeroVolts) {
  ComediBench bench;
  bench.device->Open();
  BusCommand command = Torque(20.0, 3.0);
  command.expires_ns = bench.board->now_ns() - 1;
  ASSERT_EQ(bench.Exchange(command), BusStatus::kOk);
  EXPECT_NEAR(bench.board->output_v(1), 0.0, kOutputToleranceV);
  EXPECT_NEAR(bench.board->output_v(0), 0.0, kOutputToleranceV);
}

TEST(ComediDevice, SwitchOffSetsTheVoltageToZeroBetweenTwoExchanges) {
  ComediBench bench;
  EXPECT_EQ(bench.device->SwitchOff(), BusStatus::kOk) << "not open: there is nothing to do";
  bench.device->Open();
  ASSERT_EQ(bench.Exchange(Torque(20.0, 3.0)), BusStatus::kOk);
  ASSERT_EQ(bench.device->SwitchOff(), BusStatus::kOk);
  EXPECT_NEAR(bench.board->output_v(1), 0.0, kOutputToleranceV);
  EXPECT_NEAR(bench.board->output_v(0), 0.0, kOutputToleranceV);
}

TEST(ComediDevice, CloseSetsTheVoltageToZero) {
  for (const bool by_destructor : {false, true}) {
    ComediBench bench;
    bench.device->Open();
    ASSERT_EQ(bench.Exchange(Torque(20.0, 3.0)), BusStatus::kOk);
    if (by_destructor) {
      // The device owns the board: record its outputs as it closes.
      bench.device->Close();
      bench.device.reset();
      continue;
    }
    bench.device->Close();
    EXPECT_NEAR(bench.board->output_v(1), 0.0, kOutputToleranceV);
    EXPECT_NEAR(bench.board->output_v(0), 0.0, kOutputToleranceV);
    EXPECT_FALSE(bench.board->running());
    EXPECT_FALSE(bench.board->open());
  }
}

TEST(ComediDevice, MakesNoMoreInstructionsThanItsPlan) {
  for (const ComediBoardConfig& config : {BenchBoard(), SingleReads()}) {
    ComediBench bench(config);
    bench.device->Open();
    const int before = bench.board->instructions();
    ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
    const int planned = bench.device->plan().channels.back().transaction + 1;
    const int streamed = bench.device->plan().oldest_ns > 0 ? 1 : 0;
    EXPECT_EQ(bench.board->instructions() - before, planned - streamed);
  }
}

TEST(ComediDevice, AnExchangeEndsWithinItsDeclaredTime) {
  for (const ComediBoardConfig& config : {BenchBoard(), SingleReads()}) {
    // Each instruction takes the longest time of the config, and the buffer is full.
    ComediBench bench(config, {.instruction_ns = 20'000, .read_ns = 20'000});
    bench.device->Open();
    for (int k = 0; k < 20; ++k) {
      bench.NextPeriod();
      const std::int64_t before_ns = bench.board->now_ns();
      ASSERT_EQ(bench.device->Exchange(Torque(1.0, 1.0), &bench.frame), BusStatus::kOk);
      EXPECT_LE(bench.board->now_ns() - before_ns, bench.device->worst_case_ns());
    }
    bench.board->AdvanceTo(bench.board->now_ns() + 3'000 * kMillisecond);
    const std::int64_t before_ns = bench.board->now_ns();
    static_cast<void>(bench.device->Exchange(Torque(1.0, 1.0), &bench.frame));
    EXPECT_LE(bench.board->now_ns() - before_ns, bench.device->worst_case_ns());
  }
}

TEST(ComediDevice, ExchangeAndReconnectDoNotAllocate) {
  if (!kNoAllocWorks) GTEST_SKIP() << "the sanitizers have their own allocator";
  for (const ComediBoardConfig& config : {BenchBoard(), SingleReads()}) {
    ComediBench bench(config);
    bench.device->Open();
    BusStatus exchanged = BusStatus::kTimeout, failed = BusStatus::kOk, back = BusStatus::kTimeout;
    {
      const NoAlloc guard;
      for (int k = 0; k < 20; ++k) exchanged = bench.Exchange(Torque(1.0, 1.0));
      bench.board->refuse_writes = true;
      failed = bench.Exchange(Torque(1.0, 1.0));
      bench.board->refuse_writes = false;
      back = bench.ReconnectUntilOk(5);
      bench.device->Close();
    }
    EXPECT_EQ(exchanged, BusStatus::kOk);
    EXPECT_EQ(failed, BusStatus::kDriveFault);
    EXPECT_EQ(back, BusStatus::kOk);
  }
}

}  // namespace
}  // namespace flexarm
