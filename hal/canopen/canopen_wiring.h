#pragma once

#include "hal/bus_wiring.h"
#include "hal/canopen/canopen_config.h"

namespace flexarm {

/// [[hal.canopen]] as one of the rig's buses.
class CanopenWiring final : public BusWiring {
 public:
  using Config = CanopenConfig;
  explicit CanopenWiring(CanopenConfig config) : config_(std::move(config)) {}

  const CanopenConfig& config() const noexcept { return config_; }

  const char* kind() const noexcept override { return "canopen"; }
  std::vector<Problem> Problems(const std::string& section,
                                const BusRequirements& required) const override;
  std::vector<WiredItem> Items() const override;
  BusCost Cost() const override;
  std::vector<DriveFigures> Drives() const override;
  bool reports_voltage() const noexcept override { return true; }
  std::unique_ptr<BusDevice> MakeDevice(const BusClocks& clocks) const override;

 private:
  CanopenConfig config_;
};

}  // namespace flexarm
