#pragma once

#include "hal/bus_wiring.h"
#include "hal/comedi/comedi_config.h"

namespace flexarm {

/// [[hal.comedi]] as one of the rig's buses.
class ComediWiring final : public BusWiring {
 public:
  using Config = ComediBoardConfig;
  explicit ComediWiring(ComediBoardConfig config) : config_(std::move(config)) {}

  const ComediBoardConfig& config() const noexcept { return config_; }

  const char* kind() const noexcept override { return "comedi"; }
  std::vector<Problem> Problems(const std::string& section,
                                const BusRequirements& required) const override;
  std::vector<WiredItem> Items() const override;
  std::vector<ExclusiveUse> Exclusive() const override;
  BusCost Cost() const override;
  std::vector<DriveFigures> Drives() const override;
  std::unique_ptr<BusDevice> MakeDevice(const BusClocks& clocks) const override;

 private:
  ComediBoardConfig config_;
};

}  // namespace flexarm
