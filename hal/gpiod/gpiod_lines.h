#pragma once

#include <memory>

#include "hal/gpiod/gpiod_config.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// The safety chain on GPIO lines, through libgpiod. The only file that knows its API (the first
/// one, 1.6), so that the second can follow.
///
/// All lines are requested at once and held: another process cannot turn one round. Levels are
/// read, not edges, every time. If a read fails every contact counts as open, which trips.
/// Real-time: Read and Write are one ioctl each.  Thread: safety, after construction.
class GpiodLines final : public SafetyLines {
 public:
  /// Requests the lines; relay and pump start at 0.
  /// @throws HalError naming chip, line, and who holds it if somebody does
  explicit GpiodLines(const GpiodConfig& config);
  ~GpiodLines() override;  ///< relay and pump to 0, then lets the lines go

  LineLevels Read(std::int64_t now_ns) noexcept override;
  void Write(std::int64_t now_ns, const Outputs& outputs) noexcept override;

 private:
  struct Lines;
  std::unique_ptr<Lines> lines_;
};

}  // namespace flexarm
