#pragma once

#include <optional>
#include <string_view>

#include "hal/sensor_frame.h"

namespace flexarm {

/// "limit-1-low" .. "emergency-stop", "reset-button": as in experiments and commands.
const char* Name(Line line) noexcept;

/// Nothing if there is no such line.
std::optional<Line> LineByName(std::string_view name) noexcept;

}  // namespace flexarm
