#pragma once

#include <array>
#include <cstdint>

#include "hal/count_epochs.h"
#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Compares the counters of a bus before and after the bus was reconnected. The arm is disarmed
/// then; a counter that differs by more than an arm at rest turns has lost its count, or a person
/// moved the arm unseen. It cannot be told which, nor by how many turns. Real-time: safe.
class CountWatch {
 public:
  /// Gears with backlash, links that swing, a hand that leans on the arm: less than this.
  static constexpr double kRestTurnRad = 0.035;

  explicit CountWatch(const SensorConfig& sensors);

  /// The bus was reconnected: the next reading of each counter is compared with its last one.
  void Reconnected() noexcept { compare_ = ~std::uint32_t{0}; }

  /// The readings of an exchange; only valid ones count.
  void Take(const SensorFrame& part) noexcept;

  const CountEpochs& epochs() const noexcept { return epochs_; }

 private:
  struct Counter {
    std::int64_t modulus = 1;
    double most_counts = 0.0;  // within kRestTurnRad
    std::int64_t last = 0;
  };

  std::array<Counter, kCounters> counter_;
  std::uint32_t seen_ = 0;     // bit i: `last` is set
  std::uint32_t compare_ = 0;  // bit i: compare the next reading
  CountEpochs epochs_{};
};

}  // namespace flexarm
