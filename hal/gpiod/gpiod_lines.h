#pragma once

#include "hal/gpiod/gpio_request.h"
#include "hal/gpiod/gpiod_config.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// The safety chain on GPIO lines, through libgpiod of either generation.
///
/// Every call reads levels, not edges. If a read fails every contact counts as open. The calls are
/// not timed: TimedLines does that.
/// Real-time: Read and Write are one ioctl each.  Thread: safety, after construction.
class GpiodLines final : public SafetyLines {
 public:
  /// Requests the lines, as GpioRequest does.
  /// @throws HalError
  explicit GpiodLines(const GpiodConfig& config)
      : request_(config), has_contact_(config.relay_contact.has_value()) {}

  Reading Read(std::int64_t now_ns) noexcept override;
  Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept override;
  void HoldOff() noexcept override { request_.HoldOff(); }

  /// Name of the chip in the kernel: "gpiochip0".
  const std::string& chip_name() const noexcept { return request_.chip_name(); }

 private:
  GpioRequest request_;
  bool has_contact_;
};

}  // namespace flexarm
