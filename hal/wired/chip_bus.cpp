#include "hal/wired/chip_bus.h"

#include <array>
#include <system_error>

#include "hal/bus_device.h"

namespace flexarm {
namespace {

struct Bus {
  const char* subsystem;  // as sysfs names it
  const char* name;
};
constexpr std::array<Bus, 3> kSleepingBuses = {{{"i2c", "I2C"}, {"spi", "SPI"}, {"usb", "USB"}}};

// The bus that `device` is on, as sysfs names it; empty: on none.
std::string SubsystemOf(const std::filesystem::path& device) {
  std::error_code none;
  return std::filesystem::read_symlink(device / "subsystem", none).filename().string();
}

}  // namespace

void RequireDirectChip(const std::string& chip_name, const std::filesystem::path& sysfs) {
  const std::filesystem::path link = sysfs / "bus/gpio/devices" / chip_name;
  std::error_code error;
  const std::filesystem::path root = std::filesystem::canonical(sysfs, error);
  const std::filesystem::path chip = std::filesystem::canonical(link, error);
  if (error) {
    throw HalError("gpiod " + chip_name + ": " + link.string() +
                   " does not exist, so the bus of the chip is unknown. Mount sysfs at " +
                   sysfs.string());
  }
  for (std::filesystem::path device = chip; device != root && device.has_relative_path();
       device = device.parent_path()) {
    const std::string subsystem = SubsystemOf(device);
    for (const Bus& bus : kSleepingBuses) {
      if (subsystem != bus.subsystem) continue;
      throw HalError("gpiod " + chip_name + ": the chip is on " + bus.name + " (" +
                     device.string() +
                     "): its calls wait for that bus, longer than the 0.2 ms that the safety task "
                     "has. Use lines of the processor itself or of a PCI card; see "
                     "docs/hardware.md");
    }
  }
}

}  // namespace flexarm
