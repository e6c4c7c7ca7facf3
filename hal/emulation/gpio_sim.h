#pragma once

#include <string>
#include <vector>

namespace flexarm {

/// The peer of the lines of a gpio-sim chip: sets its inputs, and reads its outputs.
/// Through sysfs, so a call is a few system calls. Emulated rig only. Thread: one.
class GpioSim {
 public:
  /// @param chip  as GpiodConfig's: "/dev/gpiochip0" or "gpiochip0"
  /// @throws HalError if that is not a gpio-sim chip
  explicit GpioSim(const std::string& chip);
  ~GpioSim();
  GpioSim(const GpioSim&) = delete;
  GpioSim& operator=(const GpioSim&) = delete;

  /// Sets the level of an input. Writes only changes, and what was forgotten.
  void Pull(int offset, bool high) noexcept;

  /// The level of an input may no longer be what was written: a request with a pull-down changes
  /// it.
  void Forget(int offset) noexcept { At(offset).pulled = -1; }

  /// Level of an output; false if it cannot be read.
  bool Value(int offset) noexcept;

 private:
  struct Line {
    int pull_fd = -1;
    int value_fd = -1;
    int pulled = -1;  // -1: unknown
  };

  Line& At(int offset) noexcept;

  std::string folder_;
  std::vector<Line> lines_;
};

}  // namespace flexarm
