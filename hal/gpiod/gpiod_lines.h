#pragma once

#include <memory>

#include "hal/gpiod/gpiod_config.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// The safety chain on GPIO lines, through libgpiod. The only file that uses its API (version 1.6,
/// the first generation), so that it can be ported to the second.
///
/// All lines are requested at once and held: no other process can reconfigure one. Every call reads
/// levels, not edges. If a read fails every contact counts as open, which trips.
/// Real-time: Read and Write are one ioctl each.  Thread: safety, after construction.
class GpiodLines final : public SafetyLines {
 public:
  /// Requests the lines; relay and pump start at 0.
  /// @throws HalError naming chip, line, and the process that holds the line, if any
  explicit GpiodLines(const GpiodConfig& config);
  ~GpiodLines() override;  ///< relay and pump to 0, then releases the lines

  LineLevels Read(std::int64_t now_ns) noexcept override;
  void Write(std::int64_t now_ns, const Outputs& outputs) noexcept override;

 private:
  struct Lines;
  std::unique_ptr<Lines> lines_;
};

}  // namespace flexarm
