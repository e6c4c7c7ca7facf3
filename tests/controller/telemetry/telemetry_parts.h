#pragma once

#include "config/config.h"
#include "controller/telemetry/telemetry_line.h"

namespace flexarm {

/// Of the thesis's rig: 20 gauges, four encoders, R12.
inline TelemetrySource ThesisSource() {
  const RigConfig config =
      LoadConfig(std::filesystem::path(FLEXARM_SOURCE_DIR) / "config/hil.toml");
  return {.rig = config.rig_name, .sensors = config.sensors, .layout = config.controller.nominal};
}

}  // namespace flexarm
