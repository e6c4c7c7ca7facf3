#include "hal/wired/bus_timing_budget.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "tests/hal/canopen/canopen_bench.h"
#include "tests/hal/comedi/comedi_bench.h"
#include "tests/hal/modbus/modbus_testing.h"

// Times against the bounds that the drivers declare and keep, drives against their data sheets.

namespace flexarm {
namespace {

HalConfig Mixed() {
  HalConfig hal;
  hal.canopen = {BenchConfig()};
  hal.modbus.device = {Amplifier(), SerialAmplifier("/dev/ttyS0")};
  hal.comedi = {BenchBoard()};
  return hal;
}

TEST(Acquisition, EveryBusAddsUpToTheBoundOfItsDriver) {
  for (const BusCost& bus : AcquisitionCosts(Mixed())) {
    std::int64_t sum_ns = bus.other_ns;
    std::set<int> counted;
    for (const ChannelCost& channel : bus.channel) {
      EXPECT_GT(channel.cost_ns, 0) << bus.name << " " << channel.channel;
      if (counted.insert(channel.transaction).second) sum_ns += channel.cost_ns;
    }
    EXPECT_EQ(sum_ns, bus.worst_ns) << bus.name;
    EXPECT_GE(bus.other_ns, 0) << bus.name;
  }
}

TEST(Acquisition, EveryChannelIsNamedOnce) {
  const std::vector<BusCost> costs = AcquisitionCosts(Mixed());
  ASSERT_EQ(costs.size(), 4U);
  EXPECT_EQ(costs[0].channel.size(), 6U);
  EXPECT_EQ(costs[1].channel.size(), Amplifier().map.size());
  EXPECT_EQ(costs[3].channel.size(), 16U);
  EXPECT_EQ(costs[3].channel[0].device, "subdevice 1");
  EXPECT_EQ(costs[3].channel[2].device, "subdevice 0");
  EXPECT_EQ(costs[3].channel[15].device, "subdevice 2");
}

TEST(Acquisition, ANodeTakesTheTimeOfItsFramesOnTheWire) {
  // CiA 301, 11-bit identifiers, every stuff bit, 1 Mbit/s: 47 + 8 n + (33 + 8 n) / 4 bits. An
  // encoder: 4 bytes of position, a heartbeat of 1, an emergency of 8: 95 + 65 + 135. A drive: 8 of
  // feedback instead of 4, and 4 of command.
  const std::vector<BusCost> costs = AcquisitionCosts(Mixed());
  EXPECT_EQ(costs[0].channel[2].cost_ns, 295'000);
  EXPECT_EQ(costs[0].channel[0].cost_ns, 430'000);
}

TEST(Acquisition, DrivesHaveTheGearsOfTheThesis) {
  HalConfig hal;
  hal.canopen = {BenchConfig()};
  hal.canopen[0].node = {BenchDrive(CanopenRole::kDrive2, 2)};
  hal.comedi = {BenchBoard()};
  hal.comedi[0].output->drive.resize(1);
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

}  // namespace
}  // namespace flexarm
