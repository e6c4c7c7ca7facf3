#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// What is wrong with the strain channels behind an amplifier: wired or set up otherwise than the
/// config says, or broken. Channels are rows of [[sensors.strain]], from 0.
class ChannelFaults {
 public:
  explicit ChannelFaults(const SensorConfig& sensors);

  void Clear() noexcept;
  void Swap(std::size_t one, std::size_t other);  ///< two plugs exchanged
  void Invert(std::size_t channel) noexcept;      ///< the bridge wired the wrong way round
  void Scale(std::size_t channel, double factor) noexcept;  ///< another gain; zero stays
  void Stick(std::size_t channel) noexcept;                 ///< repeats what it shows now
  void Freeze() noexcept;                                   ///< all repeat what they show now

  std::size_t channels() const noexcept { return offset_counts_.size(); }

  /// Turns what the gauges say into what the amplifier shows.
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
