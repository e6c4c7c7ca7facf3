#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/canopen/canopen_config.h"
#include "hal/comedi/comedi_config.h"
#include "hal/gpiod/gpiod_config.h"
#include "hal/modbus/modbus_config.h"
#include "hal/sensor_config.h"
#include "model/problem.h"

namespace flexarm {

/// Wiring of a real rig, section [hal]: buses in any combination, and the safety chain. Empty for
/// the simulated backend in the process.
struct HalConfig {
  ModbusConfig modbus;                    ///< [[hal.modbus]]
  std::vector<CanopenConfig> canopen;     ///< [[hal.canopen]]
  std::vector<ComediBoardConfig> comedi;  ///< [[hal.comedi]]
  std::optional<GpiodConfig> gpiod;       ///< [hal.gpiod]

  bool empty() const {
    return modbus.device.empty() && canopen.empty() && comedi.empty() && !gpiod;
  }

  /// Violated rules of every part, and of the whole: each sensor of the rig, each drive and the
  /// safety chain must be wired exactly once, over all buses, and every exchange must fit into the
  /// available time.
  /// @param available_ns     from the sampling instant until the step is due
  /// @param torque_limit_nm  largest torque of the loop
  std::vector<Problem> Problems(const SensorConfig& sensors, std::int64_t available_ns,
                                const std::array<double, 2>& torque_limit_nm) const;
};

}  // namespace flexarm
