#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "controller/types/frame_packet.h"
#include "controller/types/rig_config.h"
#include "tools/torture/fault.h"
#include "tools/torture/faulty_signal.h"

namespace flexarm {

/// Spoils the commands on their way from the loop to the drive's thread, before its gate.
class FaultyTorque {
 public:
  FaultyTorque(const RigConfig& config, const std::vector<Fault>& faults) {
    for (const Fault& fault : faults) {
      if (fault.place != FaultPlace::kTorque) continue;
      // Garbage is far beyond what the gate lets through.
      const auto joint = static_cast<std::size_t>(fault.index);
      const double span = 10.0 * config.safety.torque_limit_nm[joint];
      channels_.push_back(
          {.fault = &fault,
           .joint = joint,
           .signal = FaultySignal(fault.kind, span, config.loop.period_s(), fault.seed)});
    }
  }

  /// The next command, with the instant at which it acts.
  CommandHistory::Entry Next(const CommandHistory::Entry& sent) noexcept {
    CommandHistory::Entry out = sent;
    for (Channel& channel : channels_) {
      double& torque_nm = out.value.torque_nm[channel.joint];
      if (!IsActive(*channel.fault, sent.from_ns)) {
        channel.signal.See(torque_nm);
        continue;
      }
      const FaultySignal::Value faulty = channel.signal.Next(torque_nm);
      torque_nm = faulty.value;
      if (faulty.is_valid) continue;
      const bool is_nan = channel.fault->kind == FaultKind::kNotANumber;
      torque_nm = is_nan ? std::numeric_limits<double>::quiet_NaN() : 0.0;
    }
    return out;
  }

 private:
  struct Channel {
    const Fault* fault;
    std::size_t joint;
    FaultySignal signal;
  };

  std::vector<Channel> channels_;
};

}  // namespace flexarm
