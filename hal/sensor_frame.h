#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

namespace flexarm {

inline constexpr int kCounters = 4;            ///< hub 1, hub 2, rotor 1, rotor 2, as th1..th4
inline constexpr int kMaxStrainChannels = 32;  ///< both links together
inline constexpr int kAccelerometers = 1;      ///< the one at the tip

/// Digital input lines of the rig, by bit number in `LineLevels`.
///
/// Limit switches and the emergency stop are normally closed: level 1 is healthy, 0 (pressed, or a
/// cut wire) trips. The reset button is normally open: level 1 is pressed.
enum class Line : std::uint8_t {
  kLimit1Low,
  kLimit1High,
  kLimit2Low,
  kLimit2High,
  kEmergencyStop,
  kResetButton,
};
inline constexpr int kLines = 6;

/// Levels of the digital inputs, bit i is Line i.
using LineLevels = std::uint32_t;

/// Bit of `line` in LineLevels.
constexpr LineLevels LineBit(Line line) { return LineLevels{1} << static_cast<unsigned>(line); }

/// Every switch closed, the reset button released.
inline constexpr LineLevels kHealthyLevels =
    LineBit(Line::kLimit1Low) | LineBit(Line::kLimit1High) | LineBit(Line::kLimit2Low) |
    LineBit(Line::kLimit2High) | LineBit(Line::kEmergencyStop);

/// Merges redundant readings of the lines: a switch is open, and the button pressed, if one says
/// so.
constexpr LineLevels MergeRedundantLevels(LineLevels a, LineLevels b) {
  return (a & b & kHealthyLevels) | ((a | b) & ~kHealthyLevels);
}

/// All readings of the rig around one sampling instant, as raw counts.
///
/// A reading that is not valid repeats the last good value. The offset is the instant at which a
/// reading was taken, relative to `sampled_at_ns`: 0 is simultaneous sampling, a positive value is
/// the skew of a multiplexed input, a negative one an older reading; so age = now - sampled_at -
/// offset. The layout has no padding: its bytes go into the run log and are compared by replay.
struct SensorFrame {
  std::int64_t sampled_at_ns;                    ///< sampling instant, in the clock of the loop
  std::array<std::uint32_t, kCounters> counter;  ///< raw counter value, wraps at 2^counter_bits
  std::array<std::int32_t, kCounters> counter_offset_ns;
  std::array<std::int32_t, kMaxStrainChannels> strain;  ///< raw converter counts, in config order
  std::array<std::int32_t, kMaxStrainChannels> strain_offset_ns;
  std::array<std::int32_t, kAccelerometers> accelerometer;  ///< raw converter counts
  std::array<std::int32_t, kAccelerometers> accelerometer_offset_ns;
  std::uint32_t counter_valid;        ///< bit i: counter[i] was read for this frame
  std::uint32_t strain_valid;         ///< bit i: strain[i] was read for this frame
  std::uint32_t accelerometer_valid;  ///< bit i: accelerometer[i] was read for this frame
  LineLevels levels;                  ///< digital inputs at the sampling instant
};
static_assert(std::is_trivially_copyable_v<SensorFrame>);
static_assert(sizeof(SensorFrame) ==
                  8 + 2 * 4 * (kCounters + kMaxStrainChannels + kAccelerometers) + 16,
              "no padding: the bytes are logged and compared");

}  // namespace flexarm
