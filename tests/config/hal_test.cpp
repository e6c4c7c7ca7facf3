#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "config/config.h"
#include "hal/canopen/canopen_wiring.h"
#include "hal/modbus/modbus_wiring.h"
#include "tests/support/message_of.h"

// The wiring of a hardware rig: it is read from config/hil-wire.toml, and refused if it cannot
// work.

namespace flexarm {
namespace {

const std::string kFile = FLEXARM_SOURCE_DIR "/config/hil-wire.toml";

std::string WiringWith(const std::string& from, const std::string& to) {
  std::ifstream file(kFile);
  std::stringstream text;
  text << file.rdbuf();
  std::string wired = text.str();
  const std::size_t at = wired.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  wired.replace(at, from.size(), to);
  const std::string extends = "extends = \"";
  wired.insert(wired.find(extends) + extends.size(), FLEXARM_SOURCE_DIR "/config/");
  return wired;
}

// The shipped wiring after `from` is replaced by `to`.
RigConfig Loaded(const std::string& from, const std::string& to) {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string name =
      testing::TempDir() + "/" + test->name() + ".toml";  // tests run in parallel
  std::ofstream(name) << WiringWith(from, to);
  return LoadConfig(name);
}

// Its problems.
std::string Complaint(const std::string& from, const std::string& to) {
  return MessageOf<ConfigError>([&] { Loaded(from, to); });
}

TEST(HalConfig, TheShippedWiringIsRead) {
  const RigConfig config = LoadConfig(kFile);
  EXPECT_EQ(config.backend, "wired");
  const std::vector<CanopenConfig> canopen = ConfigsOf<CanopenWiring>(config.hal);
  ASSERT_EQ(canopen.size(), 1u);
  EXPECT_EQ(canopen[0].node.size(), 6u);
  EXPECT_EQ(canopen[0].node[1].gear, 48.96);
  EXPECT_EQ(canopen[0].period_ms, config.loop.period_ms);
  const std::vector<ModbusDeviceConfig> modbus = ConfigsOf<ModbusWiring>(config.hal);
  ASSERT_EQ(modbus.size(), 2u);
  EXPECT_EQ(modbus[1].map[9].index, 19);
  ASSERT_TRUE(config.hal.gpiod.has_value());
  EXPECT_EQ(config.hal.gpiod->relay, 6);
}

TEST(HalConfig, AMirrorContactOfTheRelayIsOptional) {
  EXPECT_EQ(LoadConfig(kFile).hal.gpiod->relay_contact, std::nullopt);
  const RigConfig with = Loaded("pump = 7", "pump = 7\nrelay_contact = 8");
  EXPECT_EQ(with.hal.gpiod->relay_contact, 8);
  EXPECT_THAT(Complaint("pump = 7", "pump = 7\nrelay_contact = 6"),
              testing::HasSubstr("relay_contact"));
  EXPECT_THAT(Complaint("pump = 7", "pump = 7\nrelay_contact = \"no\""),
              testing::HasSubstr("relay_contact"));
}

TEST(HalConfig, TheDrivesVoltageAsAWitnessIsOptional) {
  EXPECT_FALSE(LoadConfig(kFile).hal.gpiod->drive_voltage.has_value());
  const std::string key = "[hal.gpiod]";
  const RigConfig with =
      Loaded(key, "[hal.gpiod.drive_voltage]\nrise_ms = 300\nfall_ms = 2000\n" + key);
  ASSERT_TRUE(with.hal.gpiod->drive_voltage.has_value());
  EXPECT_EQ(with.hal.gpiod->drive_voltage->rise_ms, 300.0);
  EXPECT_EQ(with.hal.gpiod->drive_voltage->fall_ms, 2000.0);
  EXPECT_THAT(Complaint(key, "[hal.gpiod.drive_voltage]\nrise_ms = 300\n" + key),
              testing::HasSubstr("hal.gpiod.drive_voltage.fall_ms"));
  EXPECT_THAT(Complaint(key, "[hal.gpiod.drive_voltage]\nrise_ms = 5\nfall_ms = 60000\n" + key),
              testing::AllOf(testing::HasSubstr("hal.gpiod.drive_voltage.rise_ms"),
                             testing::HasSubstr("hal.gpiod.drive_voltage.fall_ms")));
}

TEST(HalConfig, TheLoggedTextGivesTheSameWiringAgain) {
  const RigConfig config = LoadConfig(kFile);
  EXPECT_EQ(ParseConfig(config.text, "log").text, config.text);
}

TEST(HalConfig, ASwitchThatRemoteIoReadsAsWellIsALineATableAndAnAddress) {
  const std::string line =
      R"(register = [{ line = "limit-1-low", table = "discrete_input", address = 3)";
  EXPECT_EQ(Complaint("register = [", line + " },"), "");
  EXPECT_THAT(Complaint("register = [", line + ", scale = 2.0 },"),
              testing::AllOf(testing::HasSubstr("scale"), testing::HasSubstr("unknown key")));
}

TEST(HalConfig, AnEncoderWithoutAReaderIsNamed) {
  EXPECT_THAT(
      Complaint("role = \"hub2\"", "role = \"hub1\""),
      testing::AllOf(testing::HasSubstr("hal.role hub2 = 0 times"),
                     testing::HasSubstr("it is in canopen[0].node[2], canopen[0].node[3]")));
}

TEST(HalConfig, AStrainChannelThatIsReadTwiceIsNamed) {
  EXPECT_THAT(
      Complaint("{ strain = 3,", "{ strain = 4,"),
      testing::AllOf(testing::HasSubstr("hal.strain[3] = 0 times"),
                     testing::HasSubstr("it is in modbus[0].register[3], modbus[0].register[4]")));
}

TEST(HalConfig, ADriveThatCannotApplyTheTorqueLimitIsRefused) {
  EXPECT_THAT(Complaint("torque_range_nm = 6.0", "torque_range_nm = 5.0"),
              testing::HasSubstr("must cover limits.torque_limit_nm = 6"));
}

TEST(HalConfig, ARigWithoutItsSafetyChainIsRefused) {
  EXPECT_THAT(Complaint("[hal.gpiod]", "[hal.gpio]"), testing::HasSubstr("hal.gpiod"));
}

TEST(HalConfig, AnExchangeThatDoesNotFitBeforeTheStepIsRefused) {
  EXPECT_THAT(Complaint("answer_timeout_ms = 5.0", "answer_timeout_ms = 12.0"),
              testing::AllOf(testing::HasSubstr("must leave room"),
                             testing::HasSubstr("drive1 430 us, drive2 430 us, hub1 295 us")));
}

// Where metal moves, no limit on late threads and unreliable buses can be switched off.
TEST(HalConfig, ALateSafetyThreadTripsBeforeADriveFindsItsPermitTooOld) {
  const auto refusal = [](const std::vector<std::string>& overrides) {
    return MessageOf<ConfigError>([&] { LoadConfig(kFile, overrides); });
  };
  EXPECT_THAT(refusal({"safety.overrun_to_trip_ms=5.5"}),
              testing::AllOf(testing::HasSubstr("safety.overrun_to_trip_ms"),
                             testing::HasSubstr("at most safety.permit_timeout_ms = 5")));
  EXPECT_NO_THROW(LoadConfig(kFile, {"safety.overrun_to_trip_ms=4.5"}));
  EXPECT_NO_THROW(LoadConfig(kFile, {"safety.overrun_to_trip_ms=8", "safety.permit_timeout_ms=8"}));
  EXPECT_NO_THROW(
      LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", {"safety.overrun_to_trip_ms=500"}))
      << "simulated: counted only";
  for (const std::string key : {"missed_deadlines", "failed_exchanges", "slow_exchanges"}) {
    const std::string limit = "safety." + key + "_in_window";
    EXPECT_THAT(refusal({limit + "=21"}),
                testing::AllOf(testing::HasSubstr(limit), testing::HasSubstr("a tenth of")));
    EXPECT_NO_THROW(LoadConfig(kFile, {limit + "=20"})) << key;
    EXPECT_NO_THROW(LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", {limit + "=200"})) << key;
  }
}

TEST(HalConfig, AnUnknownBackendIsRefused) {
  EXPECT_THAT(Complaint("backend = \"wired\"", "backend = \"real\""),
              testing::HasSubstr("one of \"sim\" \"wired\""));
}

}  // namespace
}  // namespace flexarm
