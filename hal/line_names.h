#pragma once

#include <optional>
#include <string_view>

#include "hal/sensor_frame.h"

namespace flexarm {

/// "limit-1-low" .. "emergency-stop", "reset-button": names in experiments and commands.
const char* ToString(Line line) noexcept;

/// The line with this name; empty if there is none.
std::optional<Line> LineByName(std::string_view name) noexcept;

}  // namespace flexarm
