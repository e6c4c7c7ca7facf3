#pragma once

#include "hal/gpiod/gpio_request.h"
#include "hal/gpiod/gpiod_config.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// The safety chain on GPIO lines, through libgpiod of either generation.
///
/// Every call reads levels, not edges. If a read fails every contact counts as open, which trips.
/// Real-time: Read and Write are one ioctl each.  Thread: safety, after construction.
class GpiodLines final : public SafetyLines {
 public:
  /// Requests the lines; relay and pump start at 0.
  /// @throws HalError naming chip, line, and the process that holds the line, if any
  explicit GpiodLines(const GpiodConfig& config) : request_(config) {}

  LineLevels Read(std::int64_t now_ns) noexcept override;
  void Write(std::int64_t now_ns, const Outputs& outputs) noexcept override;

 private:
  GpioRequest request_;
};

}  // namespace flexarm
