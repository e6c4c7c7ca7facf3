#pragma once

#include <memory>
#include <vector>

#include "hal/bus_device.h"
#include "hal/safety_lines.h"
#include "hal/wired/hal_config.h"

namespace flexarm {

/// The devices of a real rig, created from its config.
class HardwareRig {
 public:
  /// Opens the safety chain first, on a chip that answers in time, then every bus: identified,
  /// configured, read back.
  /// @throws HalError of the first device that fails; opened devices are closed
  HardwareRig(const HalConfig& config, const BusClocks& clocks);
  ~HardwareRig();  ///< closes the buses, torque off, then releases the lines
  HardwareRig(const HardwareRig&) = delete;
  HardwareRig& operator=(const HardwareRig&) = delete;

  std::vector<BusDevice*> buses() const;
  SafetyLines* lines() const { return lines_.get(); }

 private:
  std::unique_ptr<SafetyLines> lines_;
  std::vector<std::unique_ptr<BusDevice>> buses_;
};

}  // namespace flexarm
