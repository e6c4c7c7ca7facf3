#include "hal/comedi/comedi_fault.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>

#include "tests/hal/comedi/comedi_bench.h"

// Boards that differ, stop, are late or get stuck: each fault is named, no old reading is passed as
// new, and no torque is output meanwhile.

namespace flexarm {
namespace {

constexpr BusCommand kTorque{.torque_nm = {20.0, 3.0}, .enabled = true};
constexpr double kZeroV = 20.0 / 4096.0;

struct Refusal {
  const char* name;
  std::function<void(SimulatedDaqConfig*)> wired;
  std::function<void(ComediBoardConfig*)> config;
  const char* says;
};

class ComediOpen : public testing::TestWithParam<Refusal> {};

TEST_P(ComediOpen, RejectsABoardNamingFoundAndExpected) {
  SimulatedDaqConfig wired;
  ComediBoardConfig config = BenchBoard();
  if (GetParam().wired) GetParam().wired(&wired);
  if (GetParam().config) GetParam().config(&config);
  ComediBench bench(config, wired);
  const std::string error = bench.OpenError();
  EXPECT_NE(error.find("comedi /dev/comedi0: "), std::string::npos) << error;
  EXPECT_NE(error.find(GetParam().says), std::string::npos) << error;
}

INSTANTIATE_TEST_SUITE_P(
    Board, ComediOpen,
    testing::Values(Refusal{"AnotherDriver",
                            [](auto* w) { w->identity.driver = "ni_pcimio"; },
                            {},
                            "driver is 'ni_pcimio', expected 'sim'"},
                    Refusal{"AnotherBoard",
                            [](auto* w) { w->identity.board = "sim-8"; },
                            {},
                            "board is 'sim-8', expected 'sim-16'"},
                    Refusal{"FewerInputs",
                            [](auto* w) { w->inputs = 8; },
                            {},
                            "number of inputs is 8, expected 16"},
                    Refusal{"OtherInputBits",
                            [](auto* w) { w->input_bits = 16; },
                            {},
                            "bits of the inputs is 16, expected 12"},
                    Refusal{"NoSuchInputRange",
                            [](auto* w) { w->input_ranges.pop_back(); },
                            {},
                            "range of subdevice 0 channel 15 is -5 .. 5 V, expected -10 .. 10 V"},
                    Refusal{"NoStreaming",
                            [](auto* w) { w->streams = false; },
                            {},
                            "acquisition is possible by single reads only"},
                    Refusal{"AnotherClock",
                            [](auto* w) { w->clock_step_ns = 3000; },
                            {},
                            "scan_interval_us is 999 with the board's clock, expected 1000"},
                    Refusal{"AnotherConversion",
                            [](auto* w) { w->clock_step_ns = 40'000; },
                            {},
                            "convert_interval_us is 40 with the board's clock, expected 50"},
                    Refusal{"ASmallBuffer",
                            [](auto* w) { w->buffer_samples = 900; },
                            {},
                            "size of the input buffer is 4.5 periods"},
                    Refusal{"OneOutputOnly",
                            [](auto* w) { w->outputs = 1; },
                            {},
                            "number of outputs is 1, expected 2"},
                    Refusal{"OtherOutputBits",
                            [](auto* w) { w->output_bits = 16; },
                            {},
                            "bits of the outputs is 16, expected 12"},
                    Refusal{"AUnipolarOutput",
                            [](auto* w) { w->output_ranges = {{0.0, 10.0}}; },
                            {},
                            "channel 1 is 0 .. 10 V, expected -10 .. 10 V"},
                    Refusal{"OtherCounterBits",
                            [](auto* w) { w->counter_bits = 32; },
                            {},
                            "bits of counter hub1 of subdevice 3 is 32, expected 24"},
                    Refusal{"TooFewCounters",
                            [](auto* w) { w->counters = 2; },
                            {},
                            "counter hub1 of subdevice 3 is channel 2, expected below 2"},
                    Refusal{"ALineThatIsNone",
                            [](auto* w) { w->lines = 4; },
                            {},
                            "line limit-1-low is no input"},
                    Refusal{"AnotherKind",
                            {},
                            [](auto* c) { c->counter[0].subdevice = 2; },
                            "subdevice 2 is digital lines, expected counter"},
                    Refusal{"NoSuchSubdevice",
                            {},
                            [](auto* c) { c->counter[0].subdevice = 9; },
                            "subdevice 9 is nothing, expected counter"}),
    [](const auto& refusal) { return refusal.param.name; });

TEST(ComediOpen, RejectsABoardUsedByAnotherProgram) {
  ComediBench bench;
  bench.board->held_subdevice = 1;
  EXPECT_NE(bench.OpenError().find("subdevice 1 is held by another program"), std::string::npos);
}

TEST(ComediOpen, RejectsAnOutputThatDoesNotReturnZeroVolts) {
  ComediBench bench;
  bench.board->outputs_ignore = true;
  EXPECT_NE(bench.OpenError().find("output 1 after writing 0 V is 0, expected 2048"),
            std::string::npos)
      << bench.OpenError();
}

TEST(ComediOpen, RejectsABoardThatDoesNotScan) {
  ComediBench bench;
  bench.board->pace = 1e-6;
  const std::string error = bench.OpenError();
  EXPECT_NE(error.find("no scan has arrived: scan late, expected one every 1000 us"),
            std::string::npos)
      << error;
  ComediBench refusing;
  refusing.board->refuse_start = true;
  EXPECT_NE(refusing.OpenError().find("the board does not start to scan"), std::string::npos);
}

struct Trouble {
  const char* name;
  std::function<void(SimulatedDaqBoard*)> happens;
  std::function<void(SimulatedDaqBoard*)> ends;
  ComediFault fault;
  BusStatus status;
};

class ComediTrouble : public testing::TestWithParam<Trouble> {
 protected:
  void SetUp() override {
    bench_.device->Open();
    ASSERT_EQ(bench_.Exchange(kTorque), BusStatus::kOk);
    GetParam().happens(bench_.board);
  }
  ComediBench bench_;
};

TEST_P(ComediTrouble, IsNamedAndNoReadingIsValid) {
  const SensorFrame before = bench_.frame;
  EXPECT_EQ(bench_.Exchange(kTorque), GetParam().status);
  EXPECT_EQ(bench_.device->fault(), GetParam().fault) << ToString(bench_.device->fault());
  EXPECT_EQ(bench_.frame.strain_valid, 0U);
  EXPECT_EQ(bench_.frame.counter_valid, 0U);
  EXPECT_EQ(bench_.frame.levels, 0U);
  EXPECT_EQ(bench_.frame.strain, before.strain);  // the last good values
}

TEST_P(ComediTrouble, ALatchedFaultRemovesTheTorqueUntilReconnect) {
  static_cast<void>(bench_.Exchange(kTorque));
  if (GetParam().ends) GetParam().ends(bench_.board);
  const BusStatus next = bench_.Exchange(kTorque);
  if (!Lasts(GetParam().fault)) {
    EXPECT_EQ(next, BusStatus::kOk);  // a fault of a single exchange
    return;
  }
  EXPECT_EQ(next, GetParam().status);
  if (GetParam().fault == ComediFault::kGone) return;
  EXPECT_NEAR(bench_.board->output_v(1), 0.0, kZeroV);
  EXPECT_NEAR(bench_.board->output_v(0), 0.0, kZeroV);
}

TEST_P(ComediTrouble, ReconnectRecoversOnceTheFaultIsOver) {
  static_cast<void>(bench_.Exchange(kTorque));
  if (GetParam().ends) GetParam().ends(bench_.board);
  const BusStatus back = bench_.ReconnectUntilOk(5);
  if (GetParam().fault == ComediFault::kGone) {
    EXPECT_EQ(back, BusStatus::kDisconnected);
    return;
  }
  EXPECT_EQ(back, BusStatus::kOk);
  EXPECT_NEAR(bench_.board->output_v(1), 0.0, kZeroV);
  EXPECT_EQ(bench_.Exchange(kTorque), BusStatus::kOk);
  EXPECT_EQ(bench_.frame.strain_valid, 0x3FFU);
  EXPECT_NEAR(bench_.board->output_v(1), 5.0, kZeroV);
}

TEST_P(ComediTrouble, EndsWithinTheDeclaredTimeAndOneStuckInstructionPerOutput) {
  const bool stuck = GetParam().fault == ComediFault::kSlow;
  const std::int64_t allowed_ns =
      bench_.device->worst_case_ns() + (stuck ? 2 * bench_.board->instruction_takes_ns : 0);
  for (int k = 0; k < 10; ++k) {
    bench_.NextPeriod();
    const std::int64_t before_ns = bench_.board->now_ns();
    static_cast<void>(k % 2 == 0 ? bench_.device->Exchange(kTorque, &bench_.frame)
                                 : bench_.device->Reconnect());
    EXPECT_LE(bench_.board->now_ns() - before_ns, allowed_ns) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Board, ComediTrouble,
    testing::Values(Trouble{"NobodyReadsForTooLong",
                            [](auto* b) {
                              b->AdvanceTo(b->now_ns() + 4'000 * kMillisecond);
                            },  // 3.3 s fill the buffer
                            {},
                            ComediFault::kOverrun,
                            BusStatus::kMalformed},
                    Trouble{"TheScanEnds",
                            [](auto* b) { b->EndScan(); },
                            {},
                            ComediFault::kScanStopped,
                            BusStatus::kDisconnected},
                    Trouble{"ConversionsStop",
                            [](auto* b) { b->StopConverting(); },
                            {},
                            ComediFault::kLateScan,
                            BusStatus::kTimeout},
                    Trouble{"ConversionsAreTooFast", [](auto* b) { b->pace = 1.5; },
                            [](auto* b) { b->pace = 1.0; }, ComediFault::kEarlyScan,
                            BusStatus::kMalformed},
                    Trouble{"ReadingIsRefused", [](auto* b) { b->refuse_reads = true; },
                            [](auto* b) { b->refuse_reads = false; }, ComediFault::kReadRefused,
                            BusStatus::kMalformed},
                    Trouble{"AnOutputIsRefused", [](auto* b) { b->refuse_writes = true; },
                            [](auto* b) { b->refuse_writes = false; }, ComediFault::kOutputRefused,
                            BusStatus::kDriveFault},
                    // Comedi aborts a stuck instruction after a second.
                    Trouble{"AnInstructionIsStuck",
                            [](auto* b) { b->instruction_takes_ns = 1'000 * kMillisecond; },
                            [](auto* b) { b->instruction_takes_ns = 15'000; }, ComediFault::kSlow,
                            BusStatus::kTimeout},
                    Trouble{"AnInputReadsMoreThanItsBits",
                            [](auto* b) { b->stray_bits = 1U << 31U; },
                            [](auto* b) { b->stray_bits = 0; }, ComediFault::kBeyondRange,
                            BusStatus::kMalformed},
                    Trouble{"TheBoardIsGone",
                            [](auto* b) { b->gone = true; },
                            {},
                            ComediFault::kGone,
                            BusStatus::kDisconnected}),
    [](const auto& trouble) { return trouble.param.name; });

TEST(ComediFault, TextNamesTheBoardAndTheChannel) {
  ComediBench bench;
  bench.device->Open();
  bench.board->refuse_writes = true;
  const BusStatus refused = bench.Exchange(kTorque);
  EXPECT_EQ(bench.device->FaultText(bench.device->FaultOf(refused)),
            "/dev/comedi0: drive1: writing an output is refused");
  bench.board->refuse_writes = false;
  ASSERT_EQ(bench.ReconnectUntilOk(5), BusStatus::kOk);
  bench.board->refuse_reads = true;
  const BusStatus unread = bench.Exchange(kTorque);
  EXPECT_EQ(bench.device->FaultText(bench.device->FaultOf(unread)),
            "/dev/comedi0: hub1: reading is refused");
  bench.board->refuse_reads = false;
  bench.board->EndScan();
  const BusStatus stopped = bench.Exchange(kTorque);
  EXPECT_EQ(bench.device->FaultText(bench.device->FaultOf(stopped)),
            "/dev/comedi0: the board has stopped scanning");
}

TEST(ComediFault, AnInputThatIsReadByItselfMayNotReadMoreThanItsBits) {
  ComediBench bench(SingleReads());
  bench.device->Open();
  bench.board->stray_bits = 1U << 12U;  // of 12 bits, 0 to 11
  const BusStatus status = bench.Exchange(kTorque);
  EXPECT_EQ(status, BusStatus::kMalformed);
  EXPECT_EQ(bench.device->FaultText(bench.device->FaultOf(status)),
            "/dev/comedi0: strain[0]: reads a number beyond the bits of the converter");
  EXPECT_EQ(bench.frame.strain_valid, 0U);
}

TEST(ComediFault, EveryFaultHasAName) {
  for (int i = 0; i <= static_cast<int>(ComediFault::kBeyondRange); ++i) {
    EXPECT_STRNE(ToString(static_cast<ComediFault>(i)), "?") << i;
  }
}

}  // namespace
}  // namespace flexarm
