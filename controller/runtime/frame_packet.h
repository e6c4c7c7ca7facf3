#pragma once

#include <array>

#include "controller/runlog/records.h"
#include "controller/runtime/history.h"
#include "controller/runtime/latest_value.h"
#include "controller/runtime/messages.h"
#include "hal/safety_lines.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Drive side -> control task, at every sampling instant.
struct FramePacket {
  SensorFrame frame;
  std::array<double, 2> applied_torque_nm;  ///< after the gate: mean since the last packet
  PlantTruth truth;                         ///< simulated backend only
};
using FrameHistory = History<FramePacket, 4>;
using FrameChannel = LatestValue<FrameHistory>;

/// Control task -> drive side, stamped with the instant at which the torque acts.
using CommandHistory = History<TorqueCommand, 4>;
using CommandChannel = LatestValue<CommandHistory>;

/// Before the first frame: nothing was ever sampled.
inline constexpr FramePacket kNoFrame{};

/// No torque, from before all time: the gate finds it too old.
inline constexpr TorqueCommand kNoCommand{.torque_nm = {0.0, 0.0}, .tick = -1};

}  // namespace flexarm
