#include "hal/comedi/comedi_config.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "hal/comedi/comedi_plan.h"
#include "tests/hal/comedi/comedi_bench.h"

namespace flexarm {
namespace {

constexpr std::int64_t kAvailable_ns = 10 * kMillisecond;

std::string Text(const ComediBoardConfig& config) {
  std::string text;
  for (const Problem& p : config.Problems("hal.comedi[0].", 10, kAvailable_ns)) {
    text += p.key + " = " + p.value + ": " + p.rule + "\n";
  }
  return text;
}

struct Broken {
  const char* name;
  std::function<void(ComediBoardConfig*)> breaks;
  const char* says;
};

class ComediConfigRule : public testing::TestWithParam<Broken> {};

TEST_P(ComediConfigRule, ViolationNamesItsKey) {
  ComediBoardConfig config = BenchBoard();
  GetParam().breaks(&config);
  const std::string text = Text(config);
  EXPECT_NE(text.find(std::string("hal.comedi[0].") + GetParam().says), std::string::npos) << text;
}

INSTANTIATE_TEST_SUITE_P(
    Board, ComediConfigRule,
    testing::Values(
        Broken{"Device", [](auto* c) { c->device = "comedi0"; }, "device = comedi0"},
        Broken{"Driver", [](auto* c) { c->driver = ""; }, "driver = "},
        Broken{"Board", [](auto* c) { c->board = ""; }, "board = "},
        Broken{"Instruction", [](auto* c) { c->instruction_us = 0.0; }, "instruction_us = 0"},
        Broken{"MoreChannelsThanTheBoardHas", [](auto* c) { c->input->channels = 8; },
               "input.channel = 10 rows: must be at most the board's inputs: it has 8"},
        Broken{"AChannelThatIsNot", [](auto* c) { c->input->channel[3].channel = 16; },
               "input.channel[3].channel = 16: must lie in 0 .. 15"},
        Broken{"AChannelTwice", [](auto* c) { c->input->channel[3].channel = 15; },
               "input.channel[3].channel = 15: must be used by one row only"},
        Broken{"AStrainThatIsNot", [](auto* c) { c->input->channel[3].strain = 10; },
               "input.channel[3].strain = 10: must be a row of [[sensors.strain]]"},
        Broken{"AScanLongerThanItsInterval", [](auto* c) { c->input->convert_interval_us = 101.0; },
               "input.scan_interval_us = 1000: must hold a whole scan: 10 channels at 101 us"},
        Broken{"AScanTooSlowForTheLoop", [](auto* c) { c->input->scan_interval_us = 9400.0; },
               "input.scan_interval_us = 9400: must be short compared with the loop: the oldest "
               "reading would be 10100 us old"},
        Broken{"NothingToRead", [](auto* c) { c->input->channel.clear(); }, "input.channel"},
        Broken{"NothingToDrive", [](auto* c) { c->output->drive.clear(); }, "output.drive"},
        Broken{"AnOutputThatIsNot", [](auto* c) { c->output->drive[0].channel = 2; },
               "output.drive[0].channel = 2"},
        Broken{"AnOutputTwice", [](auto* c) { c->output->drive[0].channel = 0; },
               "output.drive[1].channel = 0: must be used by one row only"},
        Broken{"ATorqueBeyondTheVolts", [](auto* c) { c->output->drive[0].torque_range_nm = 40.5; },
               "output.drive[0].torque_range_nm = 40.5: must be above 0 and within the output's "
               "range: 10 V at 4 N m per volt (0.8 at the motor, gear 5) are 40 N m"},
        Broken{"Sign", [](auto* c) { c->output->drive[1].sign = 0; }, "output.drive[1].sign = 0"},
        Broken{"Gear", [](auto* c) { c->output->drive[1].gear = 0.2; },
               "output.drive[1].gear = 0.2"},
        Broken{"TorquePerVolt", [](auto* c) { c->output->drive[1].motor_torque_per_volt_nm = 0.0; },
               "output.drive[1].motor_torque_per_volt_nm = 0"},
        Broken{"CounterBits", [](auto* c) { c->counter[0].bits = 33; }, "counter[0].bits = 33"},
        Broken{"ACounterTwice", [](auto* c) { c->counter[0].channel = 0; },
               "counter[1].channel = 0: must be used by one row only"},
        Broken{"ALineTwice", [](auto* c) { c->line[0].channel = 5; },
               "line[1].channel = 5: must be used by one row only"}),
    [](const auto& broken) { return broken.param.name; });

TEST(ComediConfig, TheBenchConfigAndSingleReadsHaveNoProblems) {
  EXPECT_EQ(Text(BenchBoard()), "");
  EXPECT_EQ(Text(SingleReads()), "");
}

TEST(ComediConfig, ATorqueThatUsesAllTheVoltsIsAllowed) {
  ComediBoardConfig config = BenchBoard();
  config.output->drive[1] = {.joint = 1,
                             .channel = 0,
                             .motor_torque_per_volt_nm = 0.1,
                             .gear = 48.96,
                             .sign = 1,
                             .torque_range_nm = 48.96};
  EXPECT_EQ(Text(config), "");
}

// Pitfall: a USB board needs 2 ms per channel by single reads.
TEST(ComediConfig, ABoardTooSlowForItsChannelsIsRejectedNamingTheFirstThatDoesNotFit) {
  ComediBoardConfig config = SingleReads();
  config.instruction_us = 2000.0;
  const std::string text = Text(config);
  // 0.2 ms for the exchange itself, drives 4 ms, then strain[0] and strain[1]: 8.2 ms.
  EXPECT_NE(text.find("instruction_us = 2000: must leave an exchange within 10 ms: strain[2] costs "
                      "2 ms and ends at 10.2 ms; all together take 30.2 ms"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("hub2 2 ms"), std::string::npos) << text;
}

TEST(ComediConfig, TheSameBoardFitsIfItStreams) {
  ComediBoardConfig config = BenchBoard();
  config.instruction_us = 1800.0;  // two drives, two counters and one read of lines
  EXPECT_EQ(Text(config), "");
}

TEST(ComediPlan, CountsInstructionsAndTheScan) {
  const ComediPlan plan = PlanComedi(BenchBoard());
  ASSERT_EQ(plan.channels.size(), 16U);
  EXPECT_EQ(plan.channels[0].channel, "drive1");
  EXPECT_EQ(plan.channels[0].exchange_ns, 20'000);
  EXPECT_EQ(plan.channels[2].channel, "strain[0]");
  EXPECT_EQ(plan.channels[2].exchange_ns, 300'000);  // all ten together
  EXPECT_EQ(plan.channels[11].transaction, plan.channels[2].transaction);
  EXPECT_EQ(plan.channels[2].convert_ns, 50'000);
  EXPECT_EQ(plan.channels[14].exchange_ns, 20'000);
  EXPECT_EQ(plan.channels[15].transaction, plan.channels[14].transaction);  // lines, one read
  EXPECT_EQ(plan.scan_ns, 450'000);
  EXPECT_EQ(plan.oldest_ns, 1'650'000);
  // 2 drives, 2 counters, 1 read of lines; 0.3 ms for the buffer, 0.2 ms for the exchange.
  EXPECT_EQ(plan.exchange_worst_ns, 5 * 20'000 + 500'000);
}

}  // namespace
}  // namespace flexarm
