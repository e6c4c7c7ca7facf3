#pragma once

#include <array>
#include <optional>

#include "controller/types/step_types.h"

namespace flexarm {

/// Hub angles, rad, that the reference of a sample asks for, for status and telemetry; nothing if
/// no torque is allowed. Of homing its goal. Real-time: safe.
inline std::optional<std::array<double, 2>> ShownReference(const StepInput& in) noexcept {
  if (!TorqueAllowed(in.safety_state)) return std::nullopt;
  const auto& x_m = in.mode == LoopMode::kFollow ? in.reference_now.x_m : in.reference_next.x_m;
  return std::array{x_m[0], x_m[1]};
}

}  // namespace flexarm
