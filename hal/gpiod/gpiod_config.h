#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "hal/drive_voltage.h"
#include "hal/sensor_frame.h"
#include "model/problem.h"

namespace flexarm {

/// The safety chain on the lines of one GPIO chip: [hal.gpiod]. Offsets on the chip.
///
/// Inputs read 1 when their contact is closed: limit switches and emergency stop are normally
/// closed, so a cut wire reads as pressed. The relay closes at 1; the charge pump enables the
/// drives while its line toggles.
struct GpiodConfig {
  std::string chip;               ///< "/dev/gpiochip0", or a chip's name or label
  std::array<int, kLines> input;  ///< keys by ToString(Line), with underscores: limit_1_low, ..
  int relay;
  int pump;
  /// A mirror contact of the relay: closed, 1, exactly while all of its main contacts are open.
  std::optional<int> relay_contact = {};
  /// The drives' power hangs on relay and pump, and the drives report it. [hal.gpiod.drive_voltage]
  std::optional<DriveVoltageTimes> drive_voltage = {};

  /// Violated rules; every line needs its own offset.
  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
