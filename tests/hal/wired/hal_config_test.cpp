#include "hal/wired/hal_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <utility>

#include "hal/canopen/canopen_wiring.h"
#include "hal/comedi/comedi_wiring.h"
#include "hal/modbus/modbus_wiring.h"
#include "tests/hal/canopen/canopen_bench.h"
#include "tests/hal/comedi/comedi_bench.h"
#include "tests/hal/modbus/modbus_testing.h"

// The buses of a rig together: times against the bounds that the drivers declare and keep, drives
// against their data sheets, and the rules between buses.

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

template <typename Wiring>
void Add(typename Wiring::Config config, HalConfig* hal) {
  hal->Add(std::make_shared<Wiring>(std::move(config)));
}

HalConfig Mixed() {
  HalConfig hal;
  Add<CanopenWiring>(BenchConfig(), &hal);
  Add<ModbusWiring>(Amplifier(), &hal);
  Add<ModbusWiring>(SerialAmplifier("/dev/ttyS0"), &hal);
  Add<ComediWiring>(BenchBoard(), &hal);
  return hal;
}

TEST(HalConfig, EveryBusAddsUpToTheBoundOfItsDriver) {
  for (const BusCost& bus : AcquisitionCosts(Mixed())) {
    std::int64_t sum_ns = bus.other_ns();
    std::set<int> counted;
    for (const ChannelCost& channel : bus.channel) {
      EXPECT_GT(channel.cost_ns, 0) << bus.name << " " << channel.channel;
      if (counted.insert(channel.transaction).second) sum_ns += channel.cost_ns;
    }
    EXPECT_EQ(sum_ns, bus.worst_ns) << bus.name;
    EXPECT_GE(bus.other_ns(), 0) << bus.name;
  }
}

TEST(HalConfig, EveryChannelIsNamedOnce) {
  const std::vector<BusCost> costs = AcquisitionCosts(Mixed());
  ASSERT_EQ(costs.size(), 4U);
  EXPECT_EQ(costs[0].channel.size(), 6U);
  EXPECT_EQ(costs[1].channel.size(), Amplifier().map.size());
  EXPECT_EQ(costs[3].channel.size(), 16U);
  EXPECT_EQ(costs[3].channel[0].device, "subdevice 1");
  EXPECT_EQ(costs[3].channel[2].device, "subdevice 0");
  EXPECT_EQ(costs[3].channel[15].device, "subdevice 2");
}

TEST(HalConfig, ANodeTakesTheTimeOfItsFramesOnTheWire) {
  // CiA 301, 11-bit identifiers, every stuff bit, 1 Mbit/s: 47 + 8 n + (33 + 8 n) / 4 bits. An
  // encoder: 4 bytes of position, a heartbeat of 1, an emergency of 8: 95 + 65 + 135. A drive: 8 of
  // feedback instead of 4, and 4 of command.
  const std::vector<BusCost> costs = AcquisitionCosts(Mixed());
  EXPECT_EQ(costs[0].channel[2].cost_ns, 295'000);
  EXPECT_EQ(costs[0].channel[0].cost_ns, 430'000);
}

TEST(HalConfig, DrivesHaveTheGearsOfTheThesis) {
  CanopenConfig can = BenchConfig();
  can.node = {BenchDrive(CanopenRole::kDrive2, 2)};
  ComediBoardConfig board = BenchBoard();
  board.output->drive.resize(1);
  HalConfig hal;
  Add<CanopenWiring>(can, &hal);
  Add<ComediWiring>(board, &hal);
  const std::vector<DriveFigures> drives = FiguresOfDrives(hal);
  ASSERT_EQ(drives.size(), 2U);
  EXPECT_EQ(drives[0].joint, 0);
  EXPECT_EQ(drives[0].bus, "/dev/comedi0");
  EXPECT_STREQ(drives[0].unit, "V");
  EXPECT_DOUBLE_EQ(drives[0].torque_per_unit_nm, 4.0);  // 0.8 N m a volt at the motor, gear 5
  EXPECT_EQ(drives[0].unit_range, 10.0);
  EXPECT_STREQ(drives[1].unit, "per mille");
  EXPECT_EQ(drives[1].gear, 48.96);
  EXPECT_EQ(drives[1].unit_range, 1200.0);  // 7.2 N m at 0.006
}

// Problems of a rig whose buses are Modbus devices; those of sensors that no bus reads are there
// too.
std::string ProblemsOf(const std::vector<ModbusDeviceConfig>& devices) {
  HalConfig hal;
  for (const ModbusDeviceConfig& device : devices) Add<ModbusWiring>(device, &hal);
  SensorConfig sensors{};
  sensors.strain.resize(20);
  std::string text;
  for (const Problem& p :
       hal.Problems({.sensors = sensors, .available_ns = 15'000'000, .torque_limit_nm = {}})) {
    text += p.key + " = " + p.value + ": " + p.rule + "\n";
  }
  return text;
}

ModbusDeviceConfig SecondAmplifier() {
  ModbusDeviceConfig other = Amplifier();
  other.name = "other";
  other.unit = 2;
  other.map = {StrainRow(10, 0)};
  return other;
}

TEST(HalConfig, TwoModbusDevicesShareNeitherNameNorPlace) {
  EXPECT_THAT(ProblemsOf({Amplifier(), SecondAmplifier()}), Not(HasSubstr("hal.modbus[")));
  ModbusDeviceConfig twin = SecondAmplifier();
  twin.name = "amplifier";
  EXPECT_THAT(ProblemsOf({Amplifier(), twin}),
              HasSubstr("hal.modbus[1].name = amplifier: must be used for one device only"));
  twin = SecondAmplifier();
  twin.unit = 1;
  EXPECT_THAT(ProblemsOf({Amplifier(), twin}),
              HasSubstr("hal.modbus[1].host = 127.0.0.1: must be used once with this port"));
}

TEST(HalConfig, ASensorHasOneReader) {
  ModbusDeviceConfig twin = SecondAmplifier();
  twin.map = {StrainRow(3, 0)};
  EXPECT_THAT(ProblemsOf({Amplifier(), twin}),
              HasSubstr("hal.strain[3] = 2 times: must be wired exactly once: the channel of "
                        "[[sensors.strain]]; it is in modbus[0].register[3], "
                        "modbus[1].register[0]"));
  twin.map = {InputRow(Line::kResetButton, 0)};
  EXPECT_THAT(ProblemsOf({Amplifier(), twin}), HasSubstr("hal.line reset-button = 2 times"));
  ModbusDeviceConfig itself = Amplifier();
  itself.map[2].index = 1;
  EXPECT_THAT(ProblemsOf({itself}),
              HasSubstr("it is in modbus[0].register[1], modbus[0].register[2]"));
}

TEST(HalConfig, ASerialLineHasOneMaster) {
  ModbusDeviceConfig first = SerialAmplifier("/dev/ttyS0"), second = first;
  second.name = "other";
  second.unit = 2;
  second.map = {StrainRow(10, 0)};
  EXPECT_THAT(ProblemsOf({first, second}), HasSubstr("hal.modbus[1].device = /dev/ttyS0"));
}

/// A kind of bus that only this test knows: one drive, on a device that it must have alone.
class OneDriveBus final : public BusWiring {
 public:
  explicit OneDriveBus(int joint) : joint_(joint) {}
  const char* kind() const noexcept override { return "one-drive"; }
  std::vector<Problem> Problems(const std::string& section,
                                const BusRequirements& required) const override {
    if (required.available_ns >= 1'000'000) return {};
    return {{section + "time", "1 ms", "must fit"}};
  }
  std::vector<WiredItem> Items() const override {
    return {{WiredItem::Kind::kDrive, joint_, "drive"}};
  }
  std::vector<ExclusiveUse> Exclusive() const override {
    return {{"device", "/dev/drive", "/dev/drive", "must be used once"}};
  }
  BusCost Cost() const override {
    return {.kind = kind(), .name = "/dev/drive", .channel = {}, .worst_ns = 7, .oldest_ns = 0};
  }
  std::unique_ptr<BusDevice> MakeDevice(const BusClocks& /*clocks*/) const override {
    return nullptr;
  }

 private:
  int joint_;
};

TEST(HalConfig, ABusOfANewKindObeysTheSameRules) {
  HalConfig hal;
  hal.Add(std::make_shared<OneDriveBus>(0));
  hal.Add(std::make_shared<OneDriveBus>(0));
  std::vector<std::string> problems;
  for (const Problem& p :
       hal.Problems({.sensors = {}, .available_ns = 999'999, .torque_limit_nm = {}})) {
    problems.push_back(p.key + " = " + p.value);
  }
  EXPECT_THAT(problems, testing::ElementsAre(
                            "hal.one-drive[0].time = 1 ms", "hal.one-drive[1].time = 1 ms",
                            "hal.one-drive[1].device = /dev/drive", "hal.role drive1 = 2 times",
                            "hal.role drive2 = 0 times", "hal.gpiod = missing"));
  EXPECT_EQ(AcquisitionCosts(hal)[1].other_ns(), 7);
  EXPECT_THAT(ConfigsOf<CanopenWiring>(hal), IsEmpty());
}

TEST(HalConfig, ADriveThatReportsNoVoltageIsNoWitness) {
  const auto complaints = [](HalConfig hal) {
    hal.gpiod.emplace(
        GpiodConfig{.chip = "gpiochip0", .input = {0, 1, 2, 3, 4, 5}, .relay = 6, .pump = 7});
    hal.gpiod->drive_voltage = {.rise_ms = 300.0, .fall_ms = 2000.0};
    std::string text;
    for (const Problem& p :
         hal.Problems({.sensors = {}, .available_ns = 1'000'000'000, .torque_limit_nm = {}})) {
      if (p.key == "hal.gpiod.drive_voltage") text += p.rule;
    }
    return text;
  };
  HalConfig hal;
  Add<CanopenWiring>(BenchConfig(), &hal);
  Add<ModbusWiring>(Amplifier(), &hal);
  EXPECT_EQ(complaints(hal), "") << "each drive reports its own; an amplifier has none";
  hal.Add(std::make_shared<OneDriveBus>(1));
  EXPECT_THAT(complaints(hal), HasSubstr("those of one-drive[0] do not"));
}

}  // namespace
}  // namespace flexarm
