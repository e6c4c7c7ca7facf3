#include "hal/wired/hardware_rig.h"

#include <utility>

#include "hal/gpiod/gpiod_lines.h"
#include "hal/wired/chip_bus.h"
#include "hal/wired/timed_lines.h"

namespace flexarm {

HardwareRig::HardwareRig(const HalConfig& config, const BusClocks& clocks) {
  if (!config.gpiod) throw HalError("no safety chain: section [hal.gpiod] is missing");
  auto gpio = std::make_unique<GpiodLines>(*config.gpiod);
  RequireDirectChip(gpio->chip_name());
  lines_ = std::make_unique<TimedLines>(std::move(gpio), clocks.monotonic_ns);
  RequireQuickLines(lines_.get(), config.gpiod->chip);
  for (const HalConfig::Bus& bus : config.bus) buses_.push_back(bus.wiring->MakeDevice(clocks));
  for (const auto& bus : buses_) bus->Open();
}

HardwareRig::~HardwareRig() {
  for (const auto& bus : buses_) bus->Close();
}

std::vector<BusDevice*> HardwareRig::buses() const {
  std::vector<BusDevice*> all;
  all.reserve(buses_.size());
  for (const auto& bus : buses_) all.push_back(bus.get());
  return all;
}

}  // namespace flexarm
