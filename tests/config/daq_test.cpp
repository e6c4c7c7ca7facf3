#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hal/comedi/comedi_wiring.h"
#include "tests/config/config_testing.h"
#include "tests/support/message_of.h"

// A rig with DAQ boards: it is read from config/daq-rig.toml, and refused if it cannot work.

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The problems of the shipped rig with `overrides`; "" if there are none.
std::string Complaint(const std::vector<std::string>& overrides) {
  return MessageOf<ConfigError>([&] { LoadConfig(Shipped("daq-rig.toml"), overrides); });
}

TEST(DaqConfig, TheShippedBoardsAreRead) {
  const RigConfig config = LoadConfig(Shipped("daq-rig.toml"));
  EXPECT_EQ(config.backend, "wired");
  const std::vector<ComediBoardConfig> boards = ConfigsOf<ComediWiring>(config.hal);
  ASSERT_EQ(boards.size(), 2U);
  const ComediBoardConfig& first = boards[0];
  EXPECT_EQ(first.device, "/dev/comedi0");
  EXPECT_EQ(first.period_ms, config.loop.period_ms);
  ASSERT_TRUE(first.input.has_value());
  EXPECT_EQ(first.input->reference, ComediReference::kDifferential);
  EXPECT_EQ(first.input->channel.size(), 10U);
  EXPECT_EQ(first.input->scan_interval_ns(), 2'500'000);
  ASSERT_TRUE(first.output.has_value());
  ASSERT_EQ(first.output->drive.size(), 2U);
  EXPECT_EQ(first.output->drive[1].joint, 1);
  EXPECT_NEAR(first.output->drive[0].torque_per_volt_nm(), 3.0, 1e-12);
  const ComediBoardConfig& second = boards[1];
  EXPECT_FALSE(second.output.has_value());
  EXPECT_EQ(second.input->channel[9].strain, 19);
  ASSERT_EQ(second.counter.size(), 2U);
  EXPECT_EQ(second.counter[1].counter, 3);
}

TEST(DaqConfig, TheLoggedTextGivesTheSameBoardsAgain) {
  const RigConfig config = LoadConfig(Shipped("daq-rig.toml"));
  EXPECT_EQ(ParseConfig(config.text, "log").text, config.text);
}

TEST(DaqConfig, AnUnknownRoleIsRefused) {
  EXPECT_THAT(Complaint({"hal.comedi[0].counter[0].role=hub3"}),
              HasSubstr(R"(one of "hub1" "hub2" "rotor1" "rotor2")"));
  EXPECT_THAT(Complaint({"hal.comedi[0].output.drive[0].role=hub1"}),
              HasSubstr(R"(one of "drive1" "drive2")"));
  EXPECT_THAT(Complaint({"hal.comedi[0].input.acquisition=sometimes"}),
              HasSubstr(R"(one of "stream" "single")"));
}

TEST(DaqConfig, AnEncoderWithTwoReadersIsNamedWithBoth) {
  EXPECT_THAT(Complaint({"hal.comedi[1].counter[0].role=hub1"}),
              AllOf(HasSubstr("hal.role rotor1 = 0 times"), HasSubstr("hal.role hub1 = 2 times"),
                    HasSubstr("it is in comedi[0].counter[0], comedi[1].counter[0]")));
}

TEST(DaqConfig, AStrainChannelOnTwoBoardsIsNamedWithBoth) {
  EXPECT_THAT(Complaint({"hal.comedi[1].input.channel[0].strain=9"}),
              AllOf(HasSubstr("hal.strain[10] = 0 times"), HasSubstr("hal.strain[9] = 2 times"),
                    HasSubstr("it is in comedi[0].input.channel[9], comedi[1].input.channel[0]")));
}

TEST(DaqConfig, ADriveWithTwoWritersIsNamedWithBoth) {
  const std::string node =
      "{ role = \"drive1\", node_id = 1, vendor = 1, product = 1, serial = 0, "
      "torque_per_mille_nm = 0.03, sign = 1, torque_range_nm = 30.0, gear = 5.0, "
      "position_is_rotor = false }";
  const std::string bus =
      "hal.canopen=[{ interface = \"can0\", bitrate_bps = 1000000, master_node_id = 127, "
      "answer_timeout_ms = 5.0, sdo_timeout_ms = 200, boot_timeout_ms = 2000, node_heartbeat_ms = "
      "100, node_timeout_ms = 250, master_timeout_ms = 100, node = [" +
      node + "] }]";
  EXPECT_THAT(Complaint({bus}),
              AllOf(HasSubstr("hal.role drive1 = 2 times"),
                    HasSubstr("it is in canopen[0].node[0], comedi[0].output.drive[0]")));
}

TEST(DaqConfig, ALineThatIsReadTwiceIsNamedWithBoth) {
  const std::string line = ".line=[{ line = \"limit-1-low\", subdevice = 2, channel = 0 }]";
  EXPECT_THAT(Complaint({"hal.comedi[0]" + line, "hal.comedi[1]" + line}),
              AllOf(HasSubstr("hal.line limit-1-low = 2 times"),
                    HasSubstr("it is in comedi[0].line[0], comedi[1].line[0]")));
  EXPECT_EQ(Complaint({"hal.comedi[0]" + line}), "");
}

TEST(DaqConfig, ATorqueLimitBeyondTheRangeIsRefusedInVolts) {
  EXPECT_THAT(Complaint({"limits.torque_limit_nm=[33.0, 6.0]"}),
              HasSubstr("hal.comedi[0].output.drive[0].torque_range_nm = 30: must cover "
                        "limits.torque_limit_nm = 33, which takes 11 V of +-10 V"));
  EXPECT_THAT(Complaint({"hal.comedi[0].output.drive[0].torque_range_nm=31.0"}),
              HasSubstr("10 V at 3 N m per volt (0.6 at the motor, gear 5) are 30 N m"));
}

TEST(DaqConfig, MoreGaugesThanTheBoardHasInputsAreRefused) {
  EXPECT_THAT(Complaint({"hal.comedi[0].input.channels=8"}),
              HasSubstr("hal.comedi[0].input.channel = 10 rows: must be at most the board's "
                        "inputs: it has 8; more gauges need another board"));
}

TEST(DaqConfig, AScanThatDoesNotFitItsIntervalIsRefused) {
  EXPECT_THAT(Complaint({"hal.comedi[1].input.scan_interval_us=1900"}),
              HasSubstr("hal.comedi[1].input.scan_interval_us = 1900: must hold a whole scan: 10 "
                        "channels at 200 us each take 2000 us"));
}

TEST(DaqConfig, AConverterOrCounterOfAnotherWidthIsRefused) {
  EXPECT_THAT(Complaint({"hal.comedi[0].input.bits=12"}),
              HasSubstr("must be sensors.strain_input.converter_bits = 14"));
  EXPECT_THAT(Complaint({"hal.comedi[0].input.range_v=5.0"}),
              HasSubstr("must be sensors.strain_input.range_v = 10"));
  EXPECT_THAT(Complaint({"hal.comedi[0].counter[1].bits=32"}),
              HasSubstr("must be the counter_bits of its [[sensors.encoder]], 24"));
}

TEST(DaqConfig, ABoardThatIsNamedTwiceIsRefused) {
  EXPECT_THAT(Complaint({"hal.comedi[1].device=/dev/comedi0"}),
              HasSubstr("hal.comedi[1].device = /dev/comedi0: must be used for one board"));
}

// The shipped rig with its second board read one channel at a time.
std::string WithSingleReads() {
  std::string text = FileText(Shipped("daq-rig.toml"));
  text = Replaced(text, "extends = \"", "extends = \"" + Shipped("").string());
  const std::size_t second = text.rfind("acquisition = \"stream\"");
  const std::size_t end = text.find("channel = [", second);
  return text.replace(second, end - second, "acquisition = \"single\"\n  ");
}

// Pitfall: a USB board takes 2 ms for the single read of a channel.
TEST(DaqConfig, ARefusalOfSlowSingleReadsNamesTheFirstChannelThatEndsTooLate) {
  const TempFolder folder;
  const auto file = folder.Write("single.toml", WithSingleReads());
  EXPECT_NO_THROW(LoadConfig(file));  // with 50 us per read it fits
  // The exchange itself takes 0.2 ms; four channels end at 8.2 ms, the fifth ends too late; with
  // the two counters there are twelve reads.
  EXPECT_THAT(
      MessageOf<ConfigError>([&] { LoadConfig(file, {"hal.comedi[1].instruction_us=2000.0"}); }),
      AllOf(HasSubstr("hal.comedi[1].instruction_us = 2000: must leave an exchange "
                      "within 10 ms: strain[14] costs 2 ms and ends at 10.2 ms; all "
                      "together take 24.2 ms"),
            HasSubstr("strain[10] 2 ms"), HasSubstr("rotor2 2 ms"),
            HasSubstr("acquisition = \"stream\"")));
}

}  // namespace
}  // namespace flexarm
