#pragma once

#include <array>
#include <cstdint>

namespace flexarm {

/// The shortest durations of one move for payloads of an even grid from 0 to the largest, computed
/// when the experiment is accepted: what a run may choose from (docs/theory/fast-moves.md 1).
class DurationTable {
 public:
  static constexpr int kPayloads = 21;
  using Periods = std::array<std::int16_t, kPayloads>;

  DurationTable() = default;
  /// @param periods  of the payloads k max_kg / 20
  /// @param max_kg   > 0
  DurationTable(const Periods& periods, double max_kg) : periods_(periods), max_kg_(max_kg) {}

  /// Periods that are enough for every payload between the two: the largest of those at both,
  /// linear between the payloads of the grid, and of those of the grid between them; rounded up. A
  /// bound that is not finite counts as unknown: the longest. Real-time: safe.
  int Between(double low_kg, double high_kg) const noexcept;

  int Longest() const noexcept { return Between(0.0, max_kg_); }

  /// No entry longer than `most` periods.
  void LimitTo(int most) noexcept;

 private:
  double At(double point) const noexcept;

  Periods periods_{};
  double max_kg_ = 1.0;
};

}  // namespace flexarm
