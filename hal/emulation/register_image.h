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

/// The registers of a simulated device: one thread publishes, another serves them.
///
/// Each table reaches from the lowest to the highest address that the config names in it; what lies
/// between reads 0. Identification registers hold what the config expects.
/// The writer never waits; a reader that meets a write begins again, so it sees all of a
/// publication or nothing. Real-time: writing is safe.
class RegisterImage {
 public:
  struct Extent {
    int start;  ///< lowest address
    int count;  ///< 0: the device has no such table
  };

  /// @param config  as the driver's, without problems
  explicit RegisterImage(ModbusDeviceConfig config);

  /// Writer's thread. Every row of the map shows this frame, valid or not.
  void Publish(const SensorFrame& frame) noexcept;

  /// Writer's thread. True: 32-bit values are published with their registers the wrong way round.
  void SwapWords(bool swapped) noexcept { swapped_ = swapped; }
  bool has_words_to_swap() const noexcept;

  /// Writer's thread. Registers (or bits, 0 or 1) from `address` on; what lies outside is left out.
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
  std::atomic<std::uint32_t> sequence_{0};  // odd: the writer is at it
};

}  // namespace flexarm
