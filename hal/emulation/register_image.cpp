#include "hal/emulation/register_image.h"

#include <algorithm>
#include <utility>

#include "hal/modbus/modbus_value.h"

namespace flexarm {

// Why no fence is needed: cells are written with release after the odd number, and read with
// acquire before the number is read again. A reader that gets a new cell therefore also sees the
// odd number that preceded it.

RegisterImage::RegisterImage(ModbusDeviceConfig config) : config_(std::move(config)) {
  const auto reach = [this](ModbusTable table, int address, int width) {
    Extent& extent = tables_[IndexOf(table)].extent;
    const int end = std::max(extent.count == 0 ? 0 : extent.start + extent.count, address + width);
    extent.start = extent.count == 0 ? address : std::min(extent.start, address);
    extent.count = end - extent.start;
  };
  for (const ModbusIdentity& id : config_.identification) reach(id.table, id.address, 1);
  for (const ModbusRegister& row : config_.map) reach(row.table, row.address, WidthOf(row.type));
  for (Table& table : tables_) {
    table.cells =
        std::vector<std::atomic<std::uint16_t>>(static_cast<std::size_t>(table.extent.count));
  }
  for (const ModbusIdentity& id : config_.identification) {
    Write(id.table, id.address, static_cast<std::uint16_t>(id.expected));
  }
}

void RegisterImage::Begin() noexcept { sequence_.fetch_add(1, std::memory_order_acq_rel); }
void RegisterImage::End() noexcept { sequence_.fetch_add(1, std::memory_order_acq_rel); }

void RegisterImage::Write(ModbusTable table, int address, std::uint16_t cell) noexcept {
  Table& t = tables_[IndexOf(table)];
  const int at = address - t.extent.start;
  if (at < 0 || at >= t.extent.count) return;
  t.cells[static_cast<std::size_t>(at)].store(cell, std::memory_order_release);
}

void RegisterImage::Publish(const SensorFrame& frame) noexcept {
  Begin();
  for (const ModbusRegister& row : config_.map) {
    if (row.role == ModbusRole::kInput) {
      const bool level = (frame.levels & LineBit(static_cast<Line>(row.index))) != 0;
      Write(row.table, row.address, level ? 1 : 0);
      continue;
    }
    std::array<std::uint16_t, 2> words{};
    WordsFromCounts(row, frame.strain[static_cast<std::size_t>(row.index)], words.data());
    if (swapped_ && WidthOf(row.type) == 2) std::swap(words[0], words[1]);
    for (int i = 0; i < WidthOf(row.type); ++i) {
      Write(row.table, row.address + i, words[static_cast<std::size_t>(i)]);
    }
  }
  End();
}

bool RegisterImage::has_words_to_swap() const noexcept {
  return std::any_of(config_.map.begin(), config_.map.end(),
                     [](const ModbusRegister& row) { return WidthOf(row.type) == 2; });
}

void RegisterImage::Set(ModbusTable table, int address,
                        std::span<const std::uint16_t> cells) noexcept {
  Begin();
  for (const std::uint16_t cell : cells) Write(table, address++, cell);
  End();
}

RegisterImage::Extent RegisterImage::extent(ModbusTable table) const noexcept {
  return tables_[IndexOf(table)].extent;
}

void RegisterImage::Copy(ModbusTable table, std::uint16_t* cells) const noexcept {
  const Table& t = tables_[IndexOf(table)];
  for (;;) {
    const std::uint32_t before = sequence_.load(std::memory_order_acquire);
    for (std::size_t i = 0; i < static_cast<std::size_t>(t.extent.count); ++i) {
      cells[i] = t.cells[i].load(std::memory_order_acquire);
    }
    const std::uint32_t after = sequence_.load(std::memory_order_relaxed);
    if (before == after && before % 2 == 0) return;
  }
}

}  // namespace flexarm
