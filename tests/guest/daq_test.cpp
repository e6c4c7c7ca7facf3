#include <comedilib.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>

#include "hal/comedi/comedi_device.h"
#include "hal/comedi/libcomedi_board.h"
#include "tests/support/no_alloc.h"

// Inside the guest (daq.sh starts it there): the driver, libcomedi and the kernel's comedi against
// the kernel's own simulated board, comedi_test, and against a parallel port.
//
// comedi_test (drivers/comedi/drivers/comedi_test.c, kernel 6.1): 8 inputs and 8 outputs of 16
// bits. A single read of an input gives what was written to the output of the same number. A scan
// gives a sawtooth on channel 0, of +-1 V in 0.1 s, whose phase is that of CLOCK_MONOTONIC. Its
// timer has the kernel's ticks of 4 ms and fires up to two late, so that scans can be read 8 ms
// late.

namespace flexarm {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kPeriod_ns = 20 * kMillisecond;
constexpr BusCommand kOff{.torque_nm = {}, .enabled = false};

std::int64_t Monotonic() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

void SleepUntil(std::int64_t instant_ns) {
  const timespec until{.tv_sec = instant_ns / 1'000'000'000, .tv_nsec = instant_ns % 1'000'000'000};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

std::string FromEnvironment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "unset";
}

ComediBoardConfig Board(ComediAcquisition acquisition) {
  return {.device = FromEnvironment("DAQ_BOARD"),
          .driver = "comedi_test",
          .board = "comedi_test",
          .instruction_us = 100.0,
          .period_ms = 20.0,
          .input = ComediInputConfig{.subdevice = 0,
                                     .channels = 8,
                                     .bits = 16,
                                     .range_v = 10.0,
                                     .reference = ComediReference::kGround,
                                     .acquisition = acquisition,
                                     .scan_interval_us = 1000.0,
                                     .convert_interval_us = 100.0,
                                     .transfer_us = 8000.0,
                                     .channel = {{.strain = 0, .channel = 0},
                                                 {.strain = 1, .channel = 1},
                                                 {.strain = 2, .channel = 7}}},
          .output = ComediOutputConfig{.subdevice = 1,
                                       .channels = 8,
                                       .bits = 16,
                                       .range_v = 10.0,
                                       .drive = {{.joint = 0,
                                                  .channel = 0,
                                                  .motor_torque_per_volt_nm = 0.6,
                                                  .gear = 5.0,
                                                  .sign = 1,
                                                  .torque_range_nm = 30.0},
                                                 {.joint = 1,
                                                  .channel = 1,
                                                  .motor_torque_per_volt_nm = 0.0125,
                                                  .gear = 48.0,
                                                  .sign = -1,
                                                  .torque_range_nm = 6.0}}},
          .counter = {},
          .line = {}};
}

struct Bench {
  explicit Bench(const ComediBoardConfig& config)
      : device(config, std::make_unique<LibcomediBoard>(config.device, Monotonic)) {}

  BusStatus Exchange(const BusCommand& command = kOff) {
    SleepUntil((Monotonic() / kPeriod_ns + 1) * kPeriod_ns);
    const std::int64_t before_ns = Monotonic();
    const BusStatus status = device.Exchange(command, &frame);
    longest_ns = std::max(longest_ns, Monotonic() - before_ns);
    return status;
  }
  BusStatus ReconnectUntilOk() {
    BusStatus status = BusStatus::kTimeout;
    for (int k = 0; k < 10 && status != BusStatus::kOk; ++k) {
      SleepUntil(Monotonic() + kPeriod_ns);
      status = device.Reconnect();
    }
    return status;
  }

  ComediDevice device;
  SensorFrame frame{};
  std::int64_t longest_ns = 0;
};

// The voltage at the amplifiers, read through a second descriptor. The driver locks its subdevices,
// so this works only while it is closed.
lsampl_t OutputCode(unsigned channel) {
  comedi_t* board = comedi_open(FromEnvironment("DAQ_BOARD").c_str());
  lsampl_t code = 0;
  EXPECT_NE(board, nullptr);
  if (board == nullptr) return code;
  EXPECT_EQ(comedi_data_read(board, 0, channel, 0, AREF_GROUND, &code), 1);
  comedi_close(board);
  return code;
}

TEST(DaqInGuest, ABoardOfAnotherTypeIsRefused) {
  ComediBoardConfig config = Board(ComediAcquisition::kStream);
  config.board = "pci-6221";
  Bench other(config);
  try {
    other.device.Open();
    FAIL() << "was opened";
  } catch (const HalError& error) {
    EXPECT_NE(std::string(error.what()).find("board is 'comedi_test', expected 'pci-6221'"),
              std::string::npos)
        << error.what();
  }
  config = Board(ComediAcquisition::kStream);
  config.input->channels = 16;
  Bench larger(config);
  EXPECT_THROW(larger.device.Open(), HalError);
  config = Board(ComediAcquisition::kStream);
  config.input->scan_interval_us = 1000.4;  // the board counts microseconds
  Bench finer(config);
  EXPECT_THROW(finer.device.Open(), HalError);
  config.device = "/dev/comedi9";
  Bench missing(config);
  EXPECT_THROW(missing.device.Open(), HalError);
}

TEST(DaqInGuest, TorquesAreWrittenAsVoltsAndReadAsCounts) {
  Bench bench(Board(ComediAcquisition::kSingle));
  bench.device.Open();
  ASSERT_EQ(bench.Exchange({.torque_nm = {12.0, 3.0}, .enabled = true}), BusStatus::kOk);
  EXPECT_EQ(bench.frame.strain_valid, 0b111U);
  EXPECT_EQ(bench.frame.strain[0], 13107);   // 12 / (0.6 * 5) = 4 V of 10, times 2^15
  EXPECT_EQ(bench.frame.strain[1], -16384);  // 3 / (0.0125 * 48) = 5 V, sign -1
  ASSERT_EQ(bench.Exchange({.torque_nm = {12.0, 3.0}, .enabled = false}), BusStatus::kOk);
  EXPECT_EQ(bench.frame.strain[0], 0);
  EXPECT_EQ(bench.frame.strain[1], 0);
}

// The sawtooth shows the time of its own conversion, in steps of 15 us.
TEST(DaqInGuest, AStreamedReadingIsAsOldAsItsOffsetSays) {
  Bench bench(Board(ComediAcquisition::kStream));
  bench.device.Open();
  double worst_us = 0.0;
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(bench.Exchange(), BusStatus::kOk) << ToString(bench.device.fault()) << " " << k;
    ASSERT_EQ(bench.frame.strain_valid, 0b111U);
    constexpr int kAmplitude = 3276;  // 1 V, as the driver rounds it
    const int code = bench.frame.strain[0] + 32768;
    const double shown_us = (code - (32767 - kAmplitude)) * 1e5 / (2.0 * kAmplitude);
    const std::int64_t said_ns = bench.frame.sampled_at_ns + bench.frame.strain_offset_ns[0];
    const double said_us = static_cast<double>(said_ns % (100 * kMillisecond)) / 1e3;
    worst_us = std::max(worst_us, std::abs(std::remainder(shown_us - said_us, 1e5)));
    EXPECT_LE(bench.frame.strain_offset_ns[0], 0);
    EXPECT_EQ(bench.frame.strain[2], -1);  // 32767: the driver's 0 V
  }
  std::printf("streamed readings: time off by %.2f ms at most\n", worst_us / 1e3);
  // The bound of ScanClock: half of interval, transfer and reading. The sawtooth has a period of
  // 100 ms, the grid of 20 ms.
  EXPECT_LE(worst_us, 4'600.0);
}

TEST(DaqInGuest, ExchangesDoNotAllocateAndKeepTheirDeclaredTime) {
  for (const auto acquisition : {ComediAcquisition::kStream, ComediAcquisition::kSingle}) {
    Bench bench(Board(acquisition));
    bench.device.Open();
    int failed = 0;
    BusStatus back = BusStatus::kTimeout;
    {
      const NoAlloc guard;
      for (int k = 0; k < 50; ++k) {
        failed += bench.Exchange({.torque_nm = {1.0, 1.0}, .enabled = true}) != BusStatus::kOk;
      }
      back = bench.ReconnectUntilOk();
      failed += bench.Exchange() != BusStatus::kOk;
    }
    EXPECT_EQ(failed, 0);
    EXPECT_EQ(back, BusStatus::kOk);
    std::printf("exchange: %.3f ms at most, declared %.3f ms\n",
                static_cast<double>(bench.longest_ns) / 1e6,
                static_cast<double>(bench.device.worst_case_ns()) / 1e6);
    EXPECT_LE(bench.longest_ns, bench.device.worst_case_ns());
  }
}

// daq.sh makes the board's buffer 64 KiB: 32768 samples.
TEST(DaqInGuest, ABufferOverflowIsNamedAndReconnectReadsAgain) {
  ComediBoardConfig config = Board(ComediAcquisition::kStream);
  config.input->scan_interval_us = 250.0;
  config.input->convert_interval_us = 30.0;
  Bench bench(config);
  bench.device.Open();
  ASSERT_EQ(bench.Exchange({.torque_nm = {12.0, 3.0}, .enabled = true}), BusStatus::kOk);
  SleepUntil(Monotonic() + 3'500 * kMillisecond);  // 3 channels every 0.25 ms: 2.7 s fill it
  EXPECT_EQ(bench.Exchange({.torque_nm = {12.0, 3.0}, .enabled = true}), BusStatus::kMalformed);
  EXPECT_EQ(bench.device.fault(), ComediFault::kOverrun) << ToString(bench.device.fault());
  EXPECT_EQ(bench.frame.strain_valid, 0U);
  EXPECT_NE(bench.Exchange({.torque_nm = {12.0, 3.0}, .enabled = true}), BusStatus::kOk);
  EXPECT_EQ(bench.ReconnectUntilOk(), BusStatus::kOk);
  EXPECT_EQ(bench.Exchange(), BusStatus::kOk);
}

TEST(DaqInGuest, ItsOutputsAreLockedAndCloseSetsThemToZero) {
  Bench bench(Board(ComediAcquisition::kStream));
  bench.device.Open();
  ASSERT_EQ(bench.Exchange({.torque_nm = {12.0, 3.0}, .enabled = true}), BusStatus::kOk);
  comedi_t* other = comedi_open(FromEnvironment("DAQ_BOARD").c_str());
  ASSERT_NE(other, nullptr);
  EXPECT_LT(comedi_data_write(other, 1, 0, 0, AREF_GROUND, 65535), 0);
  bench.device.Close();
  EXPECT_EQ(OutputCode(0), 32768U);
  EXPECT_EQ(OutputCode(1), 32768U);
  EXPECT_EQ(comedi_data_write(other, 1, 0, 0, AREF_GROUND, 65535), 1);
  comedi_close(other);
}

// The reason for the charge pump at the amplifiers: the voltage stays.
TEST(DaqInGuest, AnOutputKeepsItsVoltageWhenTheProcessIsKilled) {
  const pid_t child = fork();
  if (child == 0) {
    Bench bench(Board(ComediAcquisition::kStream));
    bench.device.Open();
    static_cast<void>(bench.Exchange({.torque_nm = {12.0, 3.0}, .enabled = true}));
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(OutputCode(0), 32768U + 13107U);
  Bench(Board(ComediAcquisition::kStream)).device.Open();  // the next process sets it to zero
  EXPECT_EQ(OutputCode(0), 32768U);
}

// QEMU's parallel port with nothing on it: status lines ERROR, SELECT, ACK and BUSY are high, PAPER
// is low (hw/char/parallel.c); the data lines are high once they are inputs.
TEST(DaqInGuest, LinesOfAParallelPortAreRead) {
  ComediBoardConfig config{.device = FromEnvironment("DAQ_LINES"),
                           .driver = "comedi_parport",
                           .board = "comedi_parport",
                           .instruction_us = 100.0,
                           .period_ms = 20.0,
                           .input = {},
                           .output = {},
                           .counter = {},
                           .line = {{.line = Line::kLimit1Low, .subdevice = 1, .channel = 0},
                                    {.line = Line::kLimit1High, .subdevice = 1, .channel = 2},
                                    {.line = Line::kEmergencyStop, .subdevice = 1, .channel = 4},
                                    {.line = Line::kResetButton, .subdevice = 0, .channel = 3}}};
  Bench bench(config);
  bench.device.Open();
  ASSERT_EQ(bench.Exchange(), BusStatus::kOk);
  EXPECT_EQ(bench.frame.levels, LineBit(Line::kLimit1Low) | LineBit(Line::kEmergencyStop) |
                                    LineBit(Line::kResetButton));
  config.line.push_back({.line = Line::kLimit2Low, .subdevice = 2, .channel = 0});
  bench.device.Close();
  Bench output(config);
  EXPECT_THROW(output.device.Open(), HalError);  // subdevice 2 is outputs
}

}  // namespace
}  // namespace flexarm
