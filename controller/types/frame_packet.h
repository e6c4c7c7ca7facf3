#pragma once

#include <array>
#include <cstdint>

#include "controller/exchange/history.h"
#include "controller/exchange/latest_value.h"
#include "controller/types/messages.h"
#include "hal/safety_lines.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Drive side -> control task, at every sampling instant.
struct FramePacket {
  SensorFrame frame;                        ///< a bus marks its own readings valid, and no other
  std::array<double, 2> applied_torque_nm;  ///< after the gate: mean since the last packet
  std::uint32_t gate_reasons = 0;           ///< GateBits of that time: why torque was changed
  std::int64_t output_tick = -1;            ///< of the newest command that was put out; -1: none
  std::int64_t acted_ns = 0;                ///< when that one began to act
};

/// Adds the readings of another bus to `packet`: what is valid in `part` replaces what was there,
/// its instant kept; torques add, because a bus reports 0 for a drive that is not its own, and of
/// two drives the later one tells when a command acts. Real-time: safe.
void Join(const FramePacket& part, FramePacket* packet) noexcept;

using FrameHistory = History<FramePacket, 4>;
using FrameChannel = LatestValue<FrameHistory>;

/// Control task -> drive side, stamped with the instant at which the torque acts.
/// A simulated drive may be two periods and more behind the newest.
using CommandHistory = History<TorqueCommand, 8>;
using CommandChannel = LatestValue<CommandHistory>;

/// Before the first frame: nothing was ever sampled.
inline constexpr FramePacket kNoFrame{};

/// No torque, from before all time: the gate finds it too old.
inline constexpr TorqueCommand kNoCommand{.torque_nm = {0.0, 0.0}, .tick = -1};

}  // namespace flexarm
