#include "hal/emulation/rig_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <thread>

#include "controller/realtime/clock.h"
#include "hal/modbus/modbus_device.h"
#include "tests/hal/canopen/canopen_bench.h"
#include "tests/hal/modbus/modbus_testing.h"
#include "tests/hal/thesis_sensors.h"

// Commands of `flexarm rig`, and their effect on the unchanged drivers.

namespace flexarm {
namespace {

constexpr BusCommand kNoCommand{.torque_nm = {}, .enabled = false};

std::string Tell(const std::string& words, SimulatedAmplifier* amplifier) {
  std::istringstream stream(words);
  const std::string complaint = CommandAmplifier(stream, amplifier);
  while (!amplifier->server().settled()) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return complaint;
}

// An amplifier of the rig on its wire, and the unchanged driver with the same config.
class AmplifierOf : public testing::TestWithParam<ModbusTransport> {
 protected:
  void Start(ModbusDeviceConfig config) {
    config.transport = GetParam();
    config.port = 0;
    config.device = testing::TempDir() + "/flexarm-rig-" + std::to_string(getpid());
    config.response_timeout_ms = 300.0;  // the machine may be loaded
    amplifier_ = std::make_unique<SimulatedAmplifier>(config, sensors_);
    config.port = amplifier_->server().port();
    device_ = std::make_unique<ModbusDevice>(config, MonotonicNow);
    Show(0);
    device_->Open();
  }
  void SetUp() override { Start(Amplifier()); }

  // Channel i reads 100 i + add.
  void Show(std::int32_t add) {
    SensorFrame frame{};
    for (std::size_t i = 0; i < 10; ++i) {
      frame.strain[i] = 100 * static_cast<std::int32_t>(i) + add;
    }
    amplifier_->Show(frame);
  }
  std::string Tell(const std::string& words) { return flexarm::Tell(words, amplifier_.get()); }
  BusStatus Exchange() { return device_->Exchange(kNoCommand, &part_); }
  std::int32_t Reads(std::size_t channel) {
    EXPECT_EQ(Exchange(), BusStatus::kOk);
    return part_.strain[channel];
  }
  void ExpectBack() {
    EXPECT_EQ(Tell("well"), "");
    BusStatus status = Exchange();
    for (int k = 0; k < 200 && status != BusStatus::kOk; ++k) {
      SleepUntil(MonotonicNow() + 10'000'000);  // reconnection attempts pause
      if (device_->Reconnect() == BusStatus::kOk) status = Exchange();
    }
    EXPECT_EQ(status, BusStatus::kOk);
  }

  const SensorConfig sensors_ = [] {
    SensorConfig sensors = ThesisSensors();
    sensors.strain[1].offset_counts = 40.0;
    return sensors;
  }();
  std::unique_ptr<SimulatedAmplifier> amplifier_;
  std::unique_ptr<ModbusDevice> device_;
  SensorFrame part_{};
};

INSTANTIATE_TEST_SUITE_P(Wire, AmplifierOf,
                         testing::Values(ModbusTransport::kTcp, ModbusTransport::kRtu),
                         [](const auto& wire) {
                           return wire.param == ModbusTransport::kTcp ? "Tcp" : "Rtu";
                         });

TEST_P(AmplifierOf, IsReadByTheUnchangedDriver) {
  Show(7);
  EXPECT_EQ(Reads(0), 7);
  EXPECT_EQ(part_.strain[9], 907);
  EXPECT_EQ(part_.strain_valid, 0x3FFU);
}

TEST_P(AmplifierOf, EachWireFaultIsInjectedAndRemoved) {
  const struct {
    const char* words;
    BusStatus met;
  } cases[] = {{"silent", BusStatus::kTimeout},       {"late 5000", BusStatus::kTimeout},
               {"byte-by-byte", BusStatus::kTimeout}, {"half-frame", BusStatus::kTimeout},
               {"wrong-unit", BusStatus::kMalformed}, {"garbage", BusStatus::kMalformed},
               {"exception", BusStatus::kMalformed},  {"away", BusStatus::kDisconnected}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.words);
    EXPECT_EQ(Tell(c.words), "");
    EXPECT_EQ(Exchange(), c.met);
    ExpectBack();
  }
}

TEST_P(AmplifierOf, ChannelFaultsAreInjectedAndRemoved) {
  const double zero = sensors_.strain[1].offset_counts;
  ASSERT_EQ(Tell("stuck 3"), "");
  Show(5);
  EXPECT_EQ(Reads(3), 300);
  EXPECT_EQ(part_.strain[4], 405);
  ASSERT_EQ(Tell("well"), "");
  ASSERT_EQ(Tell("inverted 1"), "");
  Show(5);
  EXPECT_EQ(Reads(1), std::lround(2.0 * zero) - 105);
  EXPECT_EQ(part_.strain[3], 305);
  ASSERT_EQ(Tell("well"), "");
  ASSERT_EQ(Tell("swapped 2 8"), "");
  Show(6);
  EXPECT_EQ(Reads(2), 806);
  EXPECT_EQ(part_.strain[8], 206);
  ASSERT_EQ(Tell("well"), "");
  ASSERT_EQ(Tell("scaled 1 0.5"), "");
  Show(9);
  EXPECT_EQ(Reads(1), std::lround(zero + 0.5 * (109 - zero)));
  ASSERT_EQ(Tell("well"), "");
  ASSERT_EQ(Tell("frozen"), "");
  Show(11);
  Show(12);
  EXPECT_EQ(Reads(0), 9) << "the reading at the freeze";
  EXPECT_EQ(part_.strain[9], 909);
}

TEST_P(AmplifierOf, SwapsTheWordsOfLongValues) {
  EXPECT_EQ(Tell("wrong-word-order"), "this amplifier has no 32-bit value");
  device_.reset();
  amplifier_.reset();
  ModbusDeviceConfig config = Amplifier();
  config.map = {StrainRow(0, 0, ModbusType::kInt32), StrainRow(1, 2, ModbusType::kInt32)};
  Start(config);
  EXPECT_EQ(Reads(1), 100);
  EXPECT_EQ(Tell("wrong-word-order"), "");
  Show(0);
  EXPECT_EQ(Reads(1), 100 << 16);
}

TEST(RigCommands, ReportWhatTheyDoNotUnderstand) {
  ModbusDeviceConfig config = Amplifier();
  config.port = 0;
  SimulatedAmplifier amplifier(config, ThesisSensors());
  EXPECT_EQ(Tell("sulky", &amplifier), "unknown amplifier fault: 'sulky'");
  EXPECT_EQ(Tell("late", &amplifier), "expected a delay in ms");
  EXPECT_EQ(Tell("late -3", &amplifier), "expected a delay in ms");
  EXPECT_EQ(Tell("stuck 20", &amplifier), "expected a channel from 0 to 19");
  EXPECT_EQ(Tell("swapped 3", &amplifier), "expected a channel from 0 to 19");
  EXPECT_EQ(Tell("scaled 3 much", &amplifier), "expected a factor");
}

TEST(RigCommands, TheHelpNamesEveryFaultOfAWire) {
  for (int i = 0; i < kWireFaults; ++i) {
    const auto fault = static_cast<WireFault>(i);
    EXPECT_THAT(kRigCommands, testing::HasSubstr(ToString(fault)));
    EXPECT_EQ(WireFaultByName(ToString(fault)), fault);
  }
}

class NodeOf : public testing::Test {
 protected:
  // Sends `words` to node `i` of the bench; the driver's fault text within `exchanges`.
  std::string After(std::size_t i, const std::string& words, int exchanges = 10) {
    std::istringstream stream(words);
    EXPECT_EQ(CommandNode(stream, &bench_.node(i)), "");
    const BusCommand on{.torque_nm = {}, .enabled = true};
    for (int k = 0; k < exchanges; ++k) {
      const BusStatus status = bench_.Exchange(on);
      if (status != BusStatus::kOk) return bench_.device->FaultText(bench_.device->FaultOf(status));
    }
    return "well";
  }
  CanopenBench bench_;
};

TEST_F(NodeOf, EachNodeFaultIsInjectedAndRemoved) {
  const struct {
    std::size_t node;
    const char* words;
    const char* named;
  } cases[] = {{1, "silent", "can0: node 2 (drive2): does not answer SYNC"},
               {3, "no-answer", "can0: node 12 (hub2): does not answer SYNC"},
               {0, "no-heartbeat", "can0: node 1 (drive1): heartbeat lost"},
               {4, "short-pdo", "can0: node 13 (rotor1): sends a malformed PDO"},
               {2, "power-cycle", "can0: node 11 (hub1): left the operational state, NMT state"},
               {0, "emcy 0x2310", "can0: node 1 (drive1): emergency message 0x2310"}};
  ASSERT_TRUE(bench_.Enable());
  for (const auto& c : cases) {
    SCOPED_TRACE(c.words);
    EXPECT_EQ(After(c.node, c.words), c.named);
    EXPECT_NE(After(c.node, "well", 3), "");
    EXPECT_EQ(bench_.RecoverUntilOk(800), BusStatus::kOk);
    ASSERT_TRUE(bench_.EnableOpened());
  }
}

TEST_F(NodeOf, AnotherProductIsRejectedAtTheStart) {
  std::istringstream words("another-product");
  ASSERT_EQ(CommandNode(words, &bench_.node(1)), "");
  try {
    bench_.device->Open();
    FAIL() << "opened";
  } catch (const HalError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("node 2 (drive2)"));
  }
}

TEST_F(NodeOf, ReportsWhatItDoesNotUnderstand) {
  for (const char* words : {"emcy", "emcy 0", "emcy 0x10000", "emcy torque"}) {
    std::istringstream stream(words);
    EXPECT_EQ(CommandNode(stream, &bench_.node(0)), "expected a code from 0x0001 to 0xFFFF")
        << words;
  }
  std::istringstream stream("sulky");
  EXPECT_EQ(CommandNode(stream, &bench_.node(0)), "unknown node fault: 'sulky'");
}

}  // namespace
}  // namespace flexarm
