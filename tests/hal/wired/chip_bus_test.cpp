#include "hal/wired/chip_bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "hal/bus_device.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// A tree like sysfs: devices in each other, each with a link to its subsystem, and the list of GPIO
// chips.
class ChipBus : public testing::Test {
 protected:
  ChipBus() { fs::create_directories(sysfs_ / "bus/gpio/devices"); }
  ~ChipBus() override { fs::remove_all(sysfs_); }

  void Device(const std::string& path, const std::string& subsystem) {
    fs::create_directories(sysfs_ / "bus" / subsystem);
    fs::create_directories(sysfs_ / "devices" / path);
    fs::create_symlink(sysfs_ / "bus" / subsystem, sysfs_ / "devices" / path / "subsystem");
  }
  void Chip(const std::string& parent) {
    Device(parent + "/gpiochip1", "gpio");
    fs::create_symlink(sysfs_ / "devices" / parent / "gpiochip1",
                       sysfs_ / "bus/gpio/devices/gpiochip1");
  }
  std::string Refusal() {
    return MessageOf<HalError>([this] { RequireDirectChip("gpiochip1", sysfs_); });
  }

  fs::path sysfs_ = fs::temp_directory_path() / ("flexarm-chip-bus-" + std::to_string(getpid()));
};

TEST_F(ChipBus, LinesOfTheProcessorAreAccepted) {
  Device("platform/soc/fe200000.gpio", "platform");
  Chip("platform/soc/fe200000.gpio");
  EXPECT_EQ(Refusal(), "");
}

TEST_F(ChipBus, APciCardIsAccepted) {
  Device("pci0000:00/0000:00:1c.0", "pci");
  Device("pci0000:00/0000:00:1c.0/0000:02:00.0", "pci");
  Chip("pci0000:00/0000:00:1c.0/0000:02:00.0");
  EXPECT_EQ(Refusal(), "");
}

TEST_F(ChipBus, AnExpanderOnI2cIsRefusedByName) {
  Device("platform/soc/fe804000.i2c", "platform");
  Device("platform/soc/fe804000.i2c/i2c-1", "i2c");
  Device("platform/soc/fe804000.i2c/i2c-1/1-0020", "i2c");
  Chip("platform/soc/fe804000.i2c/i2c-1/1-0020");
  EXPECT_THAT(Refusal(), AllOf(HasSubstr("gpiod gpiochip1: the chip is on I2C"),
                               HasSubstr("i2c-1/1-0020"), HasSubstr("longer than the 0.2 ms"),
                               HasSubstr("Use lines of the processor itself or of a PCI card")));
}

TEST_F(ChipBus, AnExpanderOnSpiIsRefusedByName) {
  Device("platform/soc/fe204000.spi/spi_master/spi0/spi0.0", "spi");
  Chip("platform/soc/fe204000.spi/spi_master/spi0/spi0.0");
  EXPECT_THAT(Refusal(), AllOf(HasSubstr("the chip is on SPI"), HasSubstr("spi0.0")));
}

TEST_F(ChipBus, AUsbAdapterOnAPciControllerIsRefusedByName) {
  Device("pci0000:00/0000:00:14.0", "pci");
  Device("pci0000:00/0000:00:14.0/usb1/1-2", "usb");
  Chip("pci0000:00/0000:00:14.0/usb1/1-2");
  EXPECT_THAT(Refusal(), HasSubstr("the chip is on USB"));
}

// A power controller on I2C with lines: its GPIO part is a platform device below it.
TEST_F(ChipBus, APartOfALargerDeviceIsOnTheBusOfThatDevice) {
  Device("platform/soc/i2c-0/0-0034", "i2c");
  Device("platform/soc/i2c-0/0-0034/axp20x-gpio", "platform");
  Chip("platform/soc/i2c-0/0-0034/axp20x-gpio");
  EXPECT_THAT(Refusal(), HasSubstr("the chip is on I2C"));
}

TEST_F(ChipBus, AChipThatSysfsDoesNotShowIsRefused) {
  EXPECT_THAT(Refusal(), HasSubstr("bus/gpio/devices/gpiochip1 does not exist"));
  fs::remove_all(sysfs_);
  EXPECT_THAT(Refusal(), HasSubstr("so the bus of the chip is unknown"));
}

}  // namespace
}  // namespace flexarm
