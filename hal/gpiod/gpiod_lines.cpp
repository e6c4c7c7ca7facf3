#include "hal/gpiod/gpiod_lines.h"

namespace flexarm {

SafetyLines::Reading GpiodLines::Read(std::int64_t /*now_ns*/) noexcept {
  std::array<int, kMostGpioInputs> values{};
  if (!request_.Read(&values)) return {.levels = 0, .call = {.ok = false}};
  LineLevels levels = 0;
  for (int i = 0; i < kLines; ++i) {
    if (values[static_cast<std::size_t>(i)] != 0) levels |= LineBit(static_cast<Line>(i));
  }
  Reading reading{.levels = levels};
  if (has_contact_) {
    reading.relay = values[kLines] != 0 ? RelayContact::kOpen : RelayContact::kClosed;
  }
  return reading;
}

SafetyLines::Call GpiodLines::Write(std::int64_t /*now_ns*/, const Outputs& outputs) noexcept {
  return {.ok = request_.Write(outputs.relay_closed ? 1 : 0, outputs.pump_level ? 1 : 0)};
}

}  // namespace flexarm
