#include "hal/modbus/modbus_device.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "controller/realtime/clock.h"
#include "tests/hal/modbus/modbus_testing.h"
#include "tests/hal/modbus/served_device.h"
#include "tests/support/message_of.h"
#include "tests/support/no_alloc.h"

// The driver against our own server, over TCP and over a pseudo-terminal. Register contents are
// computed by hand: modbus_value, which both sides share, has its own test.

namespace flexarm {
namespace {

class ModbusDeviceOver : public testing::TestWithParam<ModbusTransport> {
 protected:
  static ModbusDeviceConfig DeviceConfig() {
    ModbusDeviceConfig config = Amplifier();
    config.transport = GetParam();
    return config;
  }
};

INSTANTIATE_TEST_SUITE_P(Wire, ModbusDeviceOver,
                         testing::Values(ModbusTransport::kTcp, ModbusTransport::kRtu),
                         [](const auto& wire) {
                           return wire.param == ModbusTransport::kTcp ? "Tcp" : "Rtu";
                         });

TEST_P(ModbusDeviceOver, ReadsEveryRowOfTheMap) {
  ServedDevice served(DeviceConfig());
  SensorFrame shown{};
  for (std::size_t i = 0; i < 10; ++i) shown.strain[i] = static_cast<std::int32_t>(i) * 1000 - 4000;
  shown.levels = LineBit(Line::kResetButton) | LineBit(Line::kLimit1Low);
  served.image.Publish(shown);
  ModbusDevice device(served.config(), MonotonicNow);
  device.Open();
  SensorFrame part{};
  ASSERT_EQ(device.Exchange(kDrivesOff, &part), BusStatus::kOk);
  EXPECT_EQ(part.strain_valid, 0x3FFU);
  EXPECT_EQ(part.strain, shown.strain);
  EXPECT_EQ(part.levels, LineBit(Line::kResetButton));  // the limit switch is on another bus
  EXPECT_EQ(part.counter_valid, 0U);
  EXPECT_EQ(device.strain_channels(), 0x3FFU);
  EXPECT_EQ(device.lines(), LineBit(Line::kResetButton));
}

TEST_P(ModbusDeviceOver, EachTypeIsTransferred) {
  ModbusDeviceConfig config = DeviceConfig();
  config.map = {StrainRow(0, 10, ModbusType::kInt16),
                StrainRow(1, 11, ModbusType::kUint16),
                StrainRow(2, 12, ModbusType::kInt32, ModbusWordOrder::kBig),
                StrainRow(3, 14, ModbusType::kInt32, ModbusWordOrder::kLittle),
                StrainRow(4, 16, ModbusType::kFloat32, ModbusWordOrder::kBig),
                StrainRow(5, 18, ModbusType::kFloat32, ModbusWordOrder::kLittle)};
  config.map[4].scale = 1000.0;
  config.map[5].scale = -1000.0;
  config.map[5].offset_counts = 7.0;
  ServedDevice served(config);
  const std::vector<std::uint16_t> registers = {0xFFFE, 0xFFFE, 0x0001, 0x0002, 0x0001,
                                                0x0002, 0x3FC0, 0x0000, 0x0000, 0x3FC0};
  served.image.Set(ModbusTable::kInputRegister, 10, registers);
  ModbusDevice device(served.config(), MonotonicNow);
  device.Open();
  SensorFrame part{};
  ASSERT_EQ(device.Exchange(kDrivesOff, &part), BusStatus::kOk);
  EXPECT_EQ(part.strain_valid, 0x3FU);
  const std::array<std::int32_t, 6> expected = {-2, 65534, 65538, 131073, 1500, -1493};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(part.strain[i], expected[i]) << i;
}

TEST_P(ModbusDeviceOver, ANanChannelAloneIsNotValid) {
  ModbusDeviceConfig config = DeviceConfig();
  config.map = {StrainRow(0, 0, ModbusType::kFloat32), StrainRow(1, 2, ModbusType::kFloat32)};
  ServedDevice served(config);
  const std::vector<std::uint16_t> good = {0x4120, 0x0000, 0x4120, 0x0000};  // 10, 10
  served.image.Set(ModbusTable::kInputRegister, 0, good);
  ModbusDevice device(served.config(), MonotonicNow);
  device.Open();
  SensorFrame before{}, part{};
  ASSERT_EQ(device.Exchange(kDrivesOff, &before), BusStatus::kOk);
  EXPECT_EQ(before.strain_valid, 0b11U);
  const std::vector<std::uint16_t> broken = {0x7FC0, 0x0000, 0x41A0, 0x0000};  // NaN, 20
  served.image.Set(ModbusTable::kInputRegister, 0, broken);
  ASSERT_EQ(device.Exchange(kDrivesOff, &part), BusStatus::kOk);
  EXPECT_EQ(part.strain_valid, 0b10U);
  EXPECT_EQ(part.strain[0], 10);  // the last good value, with its age
  EXPECT_EQ(part.sampled_at_ns + part.strain_offset_ns[0], before.sampled_at_ns);
  EXPECT_EQ(part.strain[1], 20);
  EXPECT_EQ(device.values_refused(), 1U);
  ASSERT_EQ(device.counter_names().size(), 7U);
  EXPECT_STREQ(device.counter_names()[6], "refused_values");
  EXPECT_EQ(device.counter_values(), (BusCounters{0, 0, 0, 0, 0, 0, 1}));
}

TEST_P(ModbusDeviceOver, StampsTheMiddleOfEachRequest) {
  ModbusDeviceConfig config = DeviceConfig();
  config.map = {StrainRow(0, 0), StrainRow(1, 50)};  // two requests
  ServedDevice served(config);
  ModbusDevice device(served.config(), MonotonicNow);
  device.Open();
  SensorFrame part{};
  const std::int64_t before_ns = MonotonicNow();
  ASSERT_EQ(device.Exchange(kDrivesOff, &part), BusStatus::kOk);
  const std::int64_t after_ns = MonotonicNow();
  const std::int64_t middle_ns = before_ns + (after_ns - before_ns) / 2;
  EXPECT_GT(part.sampled_at_ns, before_ns);
  EXPECT_EQ(part.strain_offset_ns[0], 0);
  EXPECT_GT(part.strain_offset_ns[1], 0);
  EXPECT_LT(part.sampled_at_ns + part.strain_offset_ns[1], after_ns);
  // The middle of the second request is later than the middle of both.
  EXPECT_LT(part.sampled_at_ns, middle_ns + (after_ns - before_ns) / 4);
  EXPECT_EQ(device.plan().reads.size(), 2U);
}

TEST_P(ModbusDeviceOver, SendsNoMoreRequestsThanItsPlan) {
  ServedDevice served(DeviceConfig());
  ModbusDevice device(served.config(), MonotonicNow);
  device.Open();
  const std::uint64_t before = served.server.requests();
  SensorFrame part{};
  for (int i = 0; i < 10; ++i) ASSERT_EQ(device.Exchange(kDrivesOff, &part), BusStatus::kOk);
  EXPECT_EQ(served.server.requests() - before, 20U);  // one of bits, one of registers
}

TEST_P(ModbusDeviceOver, ExchangeAndReconnectDoNotAllocate) {
  if (!kNoAllocWorks) GTEST_SKIP() << "the sanitizers have their own allocator";
  ServedDevice served(DeviceConfig());
  ModbusDeviceConfig config = served.config();
  ModbusDevice device(config, MonotonicNow);
  device.Open();
  SensorFrame part{};
  BusStatus exchanged = BusStatus::kTimeout, silent = BusStatus::kOk, back = BusStatus::kTimeout;
  {
    const NoAlloc guard;
    for (int i = 0; i < 20; ++i) exchanged = device.Exchange(kDrivesOff, &part);
  }
  served.SetSilent(true);
  {
    const NoAlloc guard;
    silent = device.Exchange(kDrivesOff, &part);
  }
  served.SetSilent(false);
  {
    const NoAlloc guard;
    back = device.Reconnect();
  }
  EXPECT_EQ(exchanged, BusStatus::kOk);
  EXPECT_EQ(silent, BusStatus::kTimeout);
  EXPECT_EQ(back, BusStatus::kOk);
}

std::string OpenError(const ModbusDeviceConfig& config) {
  return MessageOf<HalError>([&] {
    ModbusDevice device(config, MonotonicNow);
    device.Open();
  });
}

TEST_P(ModbusDeviceOver, OpenRejectsAnotherDevice) {
  ServedDevice served(DeviceConfig());
  ModbusDeviceConfig config = served.config();
  config.identification[1].expected = 8;
  const std::string text = OpenError(config);
  for (const char* part : {"'amplifier'", "holding register 101", "0x0007", "0x0008"}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

TEST_P(ModbusDeviceOver, OpenRejectsRegistersThatTheDeviceDoesNotHave) {
  ServedDevice served(DeviceConfig());
  ModbusDeviceConfig config = served.config();
  config.map.push_back(StrainRow(10, 300));
  const std::string text = OpenError(config);
  for (const char* part : {"'amplifier'", "input registers 300 .. 300", "exception 2"}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
}

TEST_P(ModbusDeviceOver, OpenRejectsAnotherUnit) {
  ServedDevice served(DeviceConfig());
  ModbusDeviceConfig config = served.config();
  config.unit = 9;
  config.response_timeout_ms = 20.0;  // over RTU no unit answers
  const std::string text = OpenError(config);
  EXPECT_NE(text.find("unit 9"), std::string::npos) << text;
  EXPECT_NE(text.find("holding registers 100 .. 101"), std::string::npos) << text;
}

TEST(ModbusDevice, OpenReportsARefusedConnection) {
  ModbusDeviceConfig config = Amplifier();
  config.port = 1;  // tcpmux, which is not in use
  const std::string text = OpenError(config);
  EXPECT_NE(text.find("127.0.0.1:1, unit 1): cannot connect: Connection refused"),
            std::string::npos)
      << text;
  config = SerialAmplifier("/dev/no-such-port");
  EXPECT_NE(OpenError(config).find("cannot connect: No such file"), std::string::npos);
}

TEST(ModbusDevice, ASerialPortWithoutLowLatencyIsRejected) {
  ModbusDeviceConfig config = SerialAmplifier("/dev/null");
  EXPECT_NE(OpenError(config), "");
}

TEST(ModbusDevice, FaultTextNamesDeviceAddressAndUnit) {
  ModbusDeviceConfig config = Amplifier();
  config.port = 1;
  ModbusDevice device(config, MonotonicNow);
  const std::string place = "modbus 'amplifier' (127.0.0.1:1, unit 1): ";
  SensorFrame part{};
  const BusStatus status = device.Exchange({.torque_nm = {}, .enabled = false}, &part);
  EXPECT_EQ(status, BusStatus::kDisconnected);
  EXPECT_EQ(device.FaultText(device.FaultOf(status)), place + "connection lost");
  EXPECT_EQ(device.FaultText(device.FaultOf(BusStatus::kTimeout)), place + "no answer in time");
  EXPECT_EQ(device.FaultText({.kind = 2, .node = 1, .code = 4}),
            place + "answers with exception 4");
}

TEST_P(ModbusDeviceOver, ReconnectsToADeviceThatReturns) {
  ModbusDeviceConfig config = DeviceConfig();
  auto served = std::make_unique<ServedDevice>(config);
  config = served->config();
  ModbusDevice device(config, MonotonicNow);
  device.Open();
  SensorFrame part{};
  served->SetSilent(true);
  EXPECT_EQ(device.Exchange(kDrivesOff, &part), BusStatus::kTimeout);
  EXPECT_EQ(part.strain_valid, 0U);
  EXPECT_NE(device.Reconnect(), BusStatus::kOk);
  served->SetSilent(false);
  BusStatus status = BusStatus::kDisconnected;
  for (int i = 0; i < 500 && status != BusStatus::kOk; ++i) {
    SleepUntil(MonotonicNow() + 10'000'000);
    status = device.Reconnect();
  }
  ASSERT_EQ(status, BusStatus::kOk);
  EXPECT_EQ(device.Exchange(kDrivesOff, &part), BusStatus::kOk);
  EXPECT_EQ(part.strain_valid, 0x3FFU);
}

}  // namespace
}  // namespace flexarm
