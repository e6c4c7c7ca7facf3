#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Fault injection for the strain channels behind an amplifier: wrong wiring or settings, or a
/// defect. Channels are rows of [[sensors.strain]], from 0.
class ChannelFaults {
 public:
  explicit ChannelFaults(const SensorConfig& sensors);

  void Clear() noexcept;
  void Swap(std::size_t one, std::size_t other);  ///< two plugs exchanged
  void Invert(std::size_t channel) noexcept;      ///< the bridge wired with inverted polarity
  void Scale(std::size_t channel, double factor) noexcept;  ///< another gain; zero stays
  void Stick(std::size_t channel) noexcept;                 ///< repeats its present reading
  void Freeze() noexcept;                                   ///< all repeat their present readings

  std::size_t channels() const noexcept { return offset_counts_.size(); }

  /// Converts the gauges' readings into the amplifier's output.
  void Apply(SensorFrame* frame) noexcept;

 private:
  StrainInputConfig input_;
  std::vector<double> offset_counts_;
  std::vector<std::pair<std::size_t, std::size_t>> swapped_;
  std::array<double, kMaxStrainChannels> factor_{};
  std::uint32_t stuck_ = 0;
  std::array<std::int32_t, kMaxStrainChannels> shown_{};
};

}  // namespace flexarm
