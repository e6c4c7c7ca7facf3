#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/modbus/modbus_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Seqlock of a simulated device's registers: one thread publishes, another serves them.
///
/// Each table extends from the lowest to the highest address that the config names in it; addresses
/// between read 0. Identification registers contain the expected values of the config.
/// The writer never waits; a reader that overlaps a write retries, so it reads a publication as a
/// whole. Real-time: writing is safe.
class RegisterImage {
 public:
  struct Extent {
    int start;  ///< lowest address
    int count;  ///< 0: the device has no such table
  };

  /// @param config  as the driver's, without problems
  explicit RegisterImage(ModbusDeviceConfig config);

  /// Writer's thread. Every row of the map contains the reading of this frame, valid or not.
  void Publish(const SensorFrame& frame) noexcept;

  /// Writer's thread. True: 32-bit values are published with their registers swapped.
  void SwapWords(bool swapped) noexcept { swapped_ = swapped; }
  bool has_words_to_swap() const noexcept;

  /// Writer's thread. Registers (or bits, 0 or 1) from `address` on; addresses outside are ignored.
  void Set(ModbusTable table, int address, std::span<const std::uint16_t> cells) noexcept;

  Extent extent(ModbusTable table) const noexcept;

  /// Reader's thread. The whole table as it was at one instant.
  /// @param cells  extent(table).count values are written
  void Copy(ModbusTable table, std::uint16_t* cells) const noexcept;

 private:
  struct Table {
    Extent extent{.start = 0, .count = 0};
    std::vector<std::atomic<std::uint16_t>> cells;
  };

  static std::size_t IndexOf(ModbusTable table) { return static_cast<std::size_t>(table) - 1; }
  void Write(ModbusTable table, int address, std::uint16_t cell) noexcept;
  void Begin() noexcept;
  void End() noexcept;

  const ModbusDeviceConfig config_;
  bool swapped_ = false;
  std::array<Table, 4> tables_;
  std::atomic<std::uint32_t> sequence_{0};  // odd: a write is in progress
};

}  // namespace flexarm
