#include "hal/emulation/channel_faults.h"

#include <algorithm>
#include <cmath>

namespace flexarm {
namespace {

std::uint32_t Bit(std::size_t channel) noexcept { return std::uint32_t{1} << channel; }

}  // namespace

ChannelFaults::ChannelFaults(const SensorConfig& sensors) : input_(sensors.strain_input) {
  for (const StrainChannelConfig& row : sensors.strain) offset_counts_.push_back(row.offset_counts);
  Clear();
}

void ChannelFaults::Clear() noexcept {
  swapped_.clear();
  factor_.fill(1.0);
  stuck_ = 0;
}

void ChannelFaults::Swap(std::size_t one, std::size_t other) { swapped_.emplace_back(one, other); }

void ChannelFaults::Invert(std::size_t channel) noexcept { factor_[channel] = -factor_[channel]; }

void ChannelFaults::Scale(std::size_t channel, double factor) noexcept {
  factor_[channel] *= factor;
}

void ChannelFaults::Stick(std::size_t channel) noexcept { stuck_ |= Bit(channel); }

void ChannelFaults::Freeze() noexcept { stuck_ = ~std::uint32_t{0}; }

void ChannelFaults::Apply(SensorFrame* frame) noexcept {
  for (const auto& [one, other] : swapped_) std::swap(frame->strain[one], frame->strain[other]);
  for (std::size_t i = 0; i < channels(); ++i) {
    std::int32_t& counts = frame->strain[i];
    if ((stuck_ & Bit(i)) != 0) {
      counts = shown_[i];
    } else if (factor_[i] != 1.0) {
      const double scaled = offset_counts_[i] + factor_[i] * (counts - offset_counts_[i]);
      const double clipped =
          std::clamp<double>(scaled, input_.lowest_count(), input_.highest_count());
      counts = static_cast<std::int32_t>(std::lround(clipped));
    }
    shown_[i] = counts;
  }
}

}  // namespace flexarm
