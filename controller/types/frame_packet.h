#pragma once

#include <array>
#include <cstdint>

#include "controller/exchange/history.h"
#include "controller/exchange/latest_value.h"
#include "controller/types/messages.h"
#include "hal/safety_lines.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Drive side -> control task, at every sampling instant: readings and applied torques.
struct FramePacket {
  SensorFrame frame;                        ///< each bus marks only its own readings valid
  std::array<double, 2> applied_torque_nm;  ///< after the gate: mean since the last packet
  std::uint32_t gate_reasons = 0;           ///< GateBits of that time: why torque was changed
  std::int64_t output_tick = -1;            ///< of the newest command that was output; -1: none
  std::int64_t acted_ns = 0;                ///< when that command began to act
};

/// Merges the readings of another bus into `packet`: valid readings of `part` replace those of
/// `packet` and keep their instants. Torques are added, because a bus reports 0 for a drive that is
/// not its own. Of two drives, the later one gives the instant at which a command acts. Real-time:
/// safe.
void Join(const FramePacket& part, FramePacket* packet) noexcept;

using FrameHistory = History<FramePacket, 4>;
using FrameChannel = LatestValue<FrameHistory>;

/// Control task -> drive side, stamped with the instant at which the torque acts.
/// A simulated drive may apply a command two periods or more older than the newest.
using CommandHistory = History<TorqueCommand, 8>;
using CommandChannel = LatestValue<CommandHistory>;

/// Value before the first frame: nothing was sampled.
inline constexpr FramePacket kNoFrame{};

/// Value before the first command: no torque, and too old for the gate.
inline constexpr TorqueCommand kNoCommand{.torque_nm = {0.0, 0.0}, .tick = -1};

}  // namespace flexarm
