#include "hal/modbus/modbus_plan.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/hal/modbus/modbus_testing.h"

// Grouping and times against figures computed by hand.

namespace flexarm {
namespace {

constexpr std::int64_t kOverheadNs = 200'000;

std::vector<ModbusRequest> Reads(const ModbusDeviceConfig& config) {
  return PlanModbus(config).reads;
}

TEST(ModbusPlan, AdjacentRowsShareARequest) {
  ModbusDeviceConfig device = Amplifier();
  const std::vector<ModbusRequest> reads = Reads(device);
  ASSERT_EQ(reads.size(), 2U);  // a bit table and a register table cannot share one
  EXPECT_EQ(reads[0].table, ModbusTable::kDiscreteInput);
  EXPECT_EQ(reads[0].address, 16);
  EXPECT_EQ(reads[0].count, 1);
  EXPECT_EQ(reads[1].address, 0);
  EXPECT_EQ(reads[1].count, 10);
  EXPECT_EQ(reads[1].rows, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(ModbusPlan, TheOrderOfTheMapDoesNotMatter) {
  ModbusDeviceConfig device = Amplifier();
  device.map = {StrainRow(0, 7), StrainRow(1, 5), StrainRow(2, 6)};
  const std::vector<ModbusRequest> reads = Reads(device);
  ASSERT_EQ(reads.size(), 1U);
  EXPECT_EQ(reads[0].address, 5);
  EXPECT_EQ(reads[0].count, 3);
  EXPECT_EQ(reads[0].rows, (std::vector<int>{1, 2, 0}));
}

TEST(ModbusPlan, AGapIsReadUpToItsLimit) {
  ModbusDeviceConfig device = Amplifier();
  device.gap_limit = 4;
  device.map = {StrainRow(0, 0), StrainRow(1, 5)};  // 1 2 3 4 are read unused
  EXPECT_EQ(Reads(device).size(), 1U);
  device.map[1].address = 6;
  EXPECT_EQ(Reads(device).size(), 2U);
}

TEST(ModbusPlan, AFrameHolds125Registers) {
  ModbusDeviceConfig device = Amplifier();
  device.gap_limit = 120;
  device.map = {StrainRow(0, 0), StrainRow(1, 100), StrainRow(2, 124)};
  EXPECT_EQ(Reads(device).size(), 1U);
  device.map[2].type = ModbusType::kInt32;  // would be split by the limit: stays whole
  const std::vector<ModbusRequest> reads = Reads(device);
  ASSERT_EQ(reads.size(), 2U);
  EXPECT_EQ(reads[0].count, 101);
  EXPECT_EQ(reads[1].address, 124);
  EXPECT_EQ(reads[1].count, 2);
}

TEST(ModbusPlan, TcpIsBoundedByItsTimeouts) {
  const ModbusPlan plan = PlanModbus(Amplifier());
  EXPECT_EQ(plan.exchange_worst_ns, 2 * (5'000'000 + kOverheadNs));
  // Connect and the one request for both identification registers.
  EXPECT_EQ(plan.reconnect_worst_ns, 2 * (5'000'000 + kOverheadNs) + kOverheadNs);
}

TEST(ModbusPlan, RtuIsBoundedByItsFramesSilencesAndTimeout) {
  ModbusDeviceConfig device = SerialAmplifier("/dev/ttyS0");
  device.map.pop_back();
  device.baud = 9600;  // a character of 1 + 8 + 1 + 1 bits takes 1.14583.. ms
  const ModbusPlan plan = PlanModbus(device);
  // Ten registers: 8 characters there, 25 back, 3.5 of silence twice: 40 in all, 45.83 ms.
  const std::int64_t ten = 45'833'334 + 5'000'000 + kOverheadNs;
  // Two registers: 24 characters in all: 27.5 ms.
  const std::int64_t two = 27'500'000 + 5'000'000 + kOverheadNs;
  EXPECT_NEAR(static_cast<double>(plan.reads[0].worst_ns), static_cast<double>(ten), 2.0);
  EXPECT_NEAR(static_cast<double>(plan.exchange_worst_ns), static_cast<double>(ten + two), 4.0);
  device.parity = ModbusParity::kNone;  // a bit less
  EXPECT_NEAR(static_cast<double>(PlanModbus(device).reads[0].worst_ns), 41'666'667.0 + 5'200'000.0,
              2.0);
  device.baud = 115200;  // 33 characters of 10 bits; the silence is fixed above 19200
  EXPECT_NEAR(static_cast<double>(PlanModbus(device).reads[0].worst_ns),
              2'864'584.0 + 2 * 1'750'000.0 + 5'200'000.0, 2.0);
}

TEST(ModbusPlan, ListsTheTimeOfEachChannel) {
  ModbusDeviceConfig device = Amplifier();
  device.map.push_back(StrainRow(10, 500));
  const std::vector<ModbusChannelCost> costs = ChannelCosts(device);
  ASSERT_EQ(costs.size(), 12U);
  EXPECT_EQ(costs[3].channel, "strain[3]");
  EXPECT_EQ(costs[3].request, 1);
  EXPECT_EQ(costs[10].channel, "reset-button");
  EXPECT_EQ(costs[10].request, 0);
  EXPECT_EQ(costs[11].request, 2);
  EXPECT_EQ(costs[11].worst_ns, 5'000'000 + kOverheadNs);
}

}  // namespace
}  // namespace flexarm
