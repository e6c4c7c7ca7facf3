#include "hal/wired/hardware_rig.h"

#include "hal/gpiod/gpiod_lines.h"

namespace flexarm {

HardwareRig::HardwareRig(const HalConfig& config, const BusClocks& clocks) {
  if (!config.gpiod) throw HalError("no safety chain: section [hal.gpiod] is missing");
  lines_ = std::make_unique<GpiodLines>(*config.gpiod);
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
