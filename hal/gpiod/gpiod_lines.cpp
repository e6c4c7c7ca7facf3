#include "hal/gpiod/gpiod_lines.h"

namespace flexarm {

LineLevels GpiodLines::Read(std::int64_t /*now_ns*/) noexcept {
  std::array<int, kLines> values{};
  if (!request_.Read(&values)) return 0;
  LineLevels levels = 0;
  for (int i = 0; i < kLines; ++i) {
    if (values[static_cast<std::size_t>(i)] != 0) levels |= LineBit(static_cast<Line>(i));
  }
  return levels;
}

void GpiodLines::Write(std::int64_t /*now_ns*/, const Outputs& outputs) noexcept {
  static_cast<void>(request_.Write(outputs.relay_closed ? 1 : 0, outputs.pump_level ? 1 : 0));
}

}  // namespace flexarm
