#include "hal/line_names.h"

#include <array>

namespace flexarm {
namespace {

constexpr std::array<const char*, kLines> kNames = {
    "limit-1-low", "limit-1-high", "limit-2-low", "limit-2-high", "emergency-stop", "reset-button"};

}  // namespace

const char* ToString(Line line) noexcept { return kNames[static_cast<std::size_t>(line)]; }

std::optional<Line> LineByName(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<Line>(i);
  }
  return std::nullopt;
}

}  // namespace flexarm
