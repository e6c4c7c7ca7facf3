#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace flexarm {

/// Fractions of a period are counted in ticks of 2^-16 Ts: 0.3 us at 50 Hz.
inline constexpr int kPeriodDigits = 16;
inline constexpr std::int64_t kPeriodTicks = std::int64_t{1} << kPeriodDigits;

/// A constant torque and its duration.
struct TorquePiece {
  std::array<double, 2> torque_nm;
  std::int64_t ticks;  ///< how long, in 2^-16 Ts

  friend bool operator==(const TorquePiece&, const TorquePiece&) = default;
};

/// The torque over an interval: constant pieces, in order of time. No heap. Real-time: safe.
class PiecewiseTorque {
 public:
  static constexpr std::size_t kMost = 8;

  PiecewiseTorque() = default;

  /// The same torque over one whole period.
  static PiecewiseTorque WholePeriod(const std::array<double, 2>& torque_nm) noexcept {
    PiecewiseTorque pieces;
    pieces.Add({.torque_nm = torque_nm, .ticks = kPeriodTicks});
    return pieces;
  }

  /// Appends a piece; no effect if it has no length, or if there are kMost already.
  void Add(const TorquePiece& piece) noexcept {
    if (piece.ticks > 0 && size_ < kMost) piece_[size_++] = piece;
  }

  std::span<const TorquePiece> all() const& noexcept { return {piece_.data(), size_}; }
  std::span<const TorquePiece> all() && = delete;  // the span would outlive the pieces

  friend bool operator==(const PiecewiseTorque& a, const PiecewiseTorque& b) noexcept {
    return std::ranges::equal(a.all(), b.all());
  }

  /// Torque at the end of the interval; 0 for an empty one.
  std::array<double, 2> last_nm() const noexcept {
    return size_ == 0 ? std::array<double, 2>{} : piece_[size_ - 1].torque_nm;
  }

  /// Mean over the interval; for a single piece exactly its torque, 0 for an empty interval.
  std::array<double, 2> mean_nm() const noexcept;

  /// Offsets all pieces so that their mean equals the measured mean; a single piece becomes the
  /// mean itself.
  PiecewiseTorque WithMean(const std::array<double, 2>& mean_nm) const noexcept;

 private:
  std::array<TorquePiece, kMost> piece_{};
  std::size_t size_ = 0;
};

}  // namespace flexarm
