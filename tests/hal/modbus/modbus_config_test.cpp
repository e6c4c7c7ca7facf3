#include "hal/modbus/modbus_config.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/hal/modbus/modbus_testing.h"

// Each rule of [[hal.modbus]] is violated once; the message must name the key.

namespace flexarm {
namespace {

constexpr std::int64_t kAvailableNs = 15'000'000;
constexpr std::size_t kStrainRows = 20;

std::vector<Problem> ProblemsOf(const ModbusDeviceConfig& device) {
  return device.Problems("hal.modbus[0].", kStrainRows, kAvailableNs);
}

std::string Text(const std::vector<Problem>& problems) {
  std::string text;
  for (const Problem& p : problems) text += p.key + " = " + p.value + ": " + p.rule + "\n";
  return text;
}

TEST(ModbusConfig, AValidConfigHasNoProblem) {
  EXPECT_EQ(Text(ProblemsOf(Amplifier())), "");
  ModbusDeviceConfig serial = SerialAmplifier("/dev/ttyS0");
  serial.map.pop_back();  // one request and its identity check fit into 15 ms
  serial.response_timeout_ms = 1.0;
  EXPECT_EQ(Text(ProblemsOf(serial)), "");
}

struct Broken {
  std::string key;   // relative to hal.modbus[0].
  std::string rule;  // a part of it
  std::function<void(ModbusDeviceConfig*)> damage;
};

class ModbusConfigRule : public testing::TestWithParam<Broken> {};

TEST_P(ModbusConfigRule, ViolationNamesKeyAndRule) {
  ModbusDeviceConfig device = Amplifier();
  GetParam().damage(&device);
  const std::vector<Problem> problems = ProblemsOf(device);
  ASSERT_FALSE(problems.empty());
  bool named = false;
  for (const Problem& p : problems) {
    named = named || (p.key == "hal.modbus[0]." + GetParam().key &&
                      p.rule.find(GetParam().rule) != std::string::npos);
  }
  EXPECT_TRUE(named) << Text(problems);
}

void MakeSerial(ModbusDeviceConfig* d) {
  *d = SerialAmplifier("/dev/ttyS0");
  d->map.pop_back();
  d->response_timeout_ms = 1.0;
}

const std::vector<Broken> kBroken = {
    {"name", "empty", [](auto* d) { d->name.clear(); }},
    {"host", "IPv4", [](auto* d) { d->host = "amplifier.local"; }},
    {"port", "1 .. 65535", [](auto* d) { d->port = 0; }},
    {"unit", "0 .. 247", [](auto* d) { d->unit = 248; }},
    {"unit", "broadcast", [](auto* d) { MakeSerial(d), d->unit = 0; }},
    {"device", "absolute path", [](auto* d) { MakeSerial(d), d->device = "ttyS0"; }},
    {"baud", "115200", [](auto* d) { MakeSerial(d), d->baud = 115201; }},
    {"data_bits", "must be 8", [](auto* d) { MakeSerial(d), d->data_bits = 7; }},
    {"stop_bits", "1 .. 2", [](auto* d) { MakeSerial(d), d->stop_bits = 0; }},
    {"identification", "late reply",
     [](auto* d) {
       MakeSerial(d);
       d->identification = {{ModbusTable::kInputRegister, 100, 1}};
       d->map = {StrainRow(0, 0)};  // the same table, the same number
     }},
    {"response_timeout_ms", "0.5 .. 1000", [](auto* d) { d->response_timeout_ms = 0.0; }},
    {"response_timeout_ms", "0.5 .. 1000",
     [](auto* d) { d->response_timeout_ms = std::numeric_limits<double>::quiet_NaN(); }},
    {"response_timeout_ms", "reset-button together 8.2 ms",
     [](auto* d) { d->response_timeout_ms = 8.0; }},
    {"gap_limit", "0 .. 120", [](auto* d) { d->gap_limit = -1; }},
    {"identification", "identifies the device", [](auto* d) { d->identification.clear(); }},
    {"identification[1].table", "register",
     [](auto* d) { d->identification[1].table = ModbusTable::kCoil; }},
    {"identification[1].address", "0 .. 65535",
     [](auto* d) { d->identification[1].address = 65536; }},
    {"identification[1].address", "one row only",
     [](auto* d) { d->identification[1].address = d->identification[0].address; }},
    {"identification[0].expected", "16 bits",
     [](auto* d) { d->identification[0].expected = 65536; }},
    {"register", "at least one row", [](auto* d) { d->map.clear(); }},
    {"register[2].strain", "it has rows: 20", [](auto* d) { d->map[2].index = 20; }},
    {"register[2].table", "a strain is a number",
     [](auto* d) { d->map[2].table = ModbusTable::kCoil; }},
    {"register[2].type", "a strain is a number",
     [](auto* d) { d->map[2].type = ModbusType::kBit; }},
    {"register[2].scale", "other than 0", [](auto* d) { d->map[2].scale = 0.0; }},
    {"register[2].scale", "32 bits", [](auto* d) { d->map[2].scale = 65536.0; }},
    {"register[2].offset_counts", "a number",
     [](auto* d) { d->map[2].offset_counts = std::numeric_limits<double>::infinity(); }},
    {"register[3].address", "overlap register[2]",
     [](auto* d) { d->map[2].type = ModbusType::kInt32; }},
    {"register[9].address", "with all of its registers",
     [](auto* d) {
       d->map[9].address = 65535;
       d->map[9].type = ModbusType::kFloat32;
     }},
    {"register[10].input", "digital input", [](auto* d) { d->map[10].index = kLines; }},
    {"register[10].table", "is a bit",
     [](auto* d) { d->map[10].table = ModbusTable::kInputRegister; }},
    {"register[10].type", "is a bit", [](auto* d) { d->map[10].type = ModbusType::kUint16; }},
};

INSTANTIATE_TEST_SUITE_P(All, ModbusConfigRule, testing::ValuesIn(kBroken),
                         [](const auto& broken) { return "case" + std::to_string(broken.index); });

}  // namespace
}  // namespace flexarm
