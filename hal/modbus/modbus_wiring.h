#pragma once

#include "hal/bus_wiring.h"
#include "hal/modbus/modbus_config.h"

namespace flexarm {

/// [[hal.modbus]] as one of the rig's buses.
class ModbusWiring final : public BusWiring {
 public:
  using Config = ModbusDeviceConfig;
  explicit ModbusWiring(ModbusDeviceConfig config) : config_(std::move(config)) {}

  const ModbusDeviceConfig& config() const noexcept { return config_; }

  const char* kind() const noexcept override { return "modbus"; }
  std::vector<Problem> Problems(const std::string& section,
                                const BusRequirements& required) const override;
  std::vector<WiredItem> Items() const override;
  std::vector<ExclusiveUse> Exclusive() const override;
  BusCost Cost() const override;
  std::unique_ptr<BusDevice> MakeDevice(const BusClocks& clocks) const override;

 private:
  ModbusDeviceConfig config_;
};

}  // namespace flexarm
