#include "hal/modbus/modbus_value.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace flexarm {
namespace {

using Int16 = std::numeric_limits<std::int16_t>;
using Uint16 = std::numeric_limits<std::uint16_t>;
using Int32 = std::numeric_limits<std::int32_t>;

std::uint32_t Joined(ModbusWordOrder order, const std::uint16_t* words) noexcept {
  std::uint32_t high = words[0], low = words[1];
  if (order == ModbusWordOrder::kLittle) std::swap(high, low);
  return high << 16U | low;
}

void Split(ModbusWordOrder order, std::uint32_t bits, std::uint16_t* words) noexcept {
  words[0] = static_cast<std::uint16_t>(bits >> 16U);
  words[1] = static_cast<std::uint16_t>(bits);
  if (order == ModbusWordOrder::kLittle) std::swap(words[0], words[1]);
}

double ValueFromWords(const ModbusRegister& row, const std::uint16_t* words) noexcept {
  switch (row.type) {
    case ModbusType::kBit:
    case ModbusType::kUint16:
      return words[0];
    case ModbusType::kInt16:
      return static_cast<std::int16_t>(words[0]);
    case ModbusType::kInt32:
      return static_cast<std::int32_t>(Joined(row.word_order, words));
    case ModbusType::kFloat32:
      return static_cast<double>(std::bit_cast<float>(Joined(row.word_order, words)));
  }
  return 0.0;
}

template <typename Limits>
double Clipped(double value) noexcept {
  return std::round(
      std::clamp(value, static_cast<double>(Limits::min()), static_cast<double>(Limits::max())));
}

}  // namespace

std::optional<std::int32_t> CountsFromWords(const ModbusRegister& row,
                                            const std::uint16_t* words) noexcept {
  const double counts = std::round(row.scale * ValueFromWords(row, words) + row.offset_counts);
  const bool fits = counts >= static_cast<double>(Int32::min()) &&
                    counts <= static_cast<double>(Int32::max());  // false for NaN
  if (!fits) return std::nullopt;
  return static_cast<std::int32_t>(counts);
}

void WordsFromCounts(const ModbusRegister& row, std::int32_t counts,
                     std::uint16_t* words) noexcept {
  const double value = (counts - row.offset_counts) / row.scale;
  switch (row.type) {
    case ModbusType::kBit:
    case ModbusType::kUint16:
      words[0] = static_cast<std::uint16_t>(Clipped<Uint16>(value));
      break;
    case ModbusType::kInt16:
      words[0] = static_cast<std::uint16_t>(static_cast<std::int16_t>(Clipped<Int16>(value)));
      break;
    case ModbusType::kInt32:
      Split(row.word_order,
            static_cast<std::uint32_t>(static_cast<std::int32_t>(Clipped<Int32>(value))), words);
      break;
    case ModbusType::kFloat32:
      Split(row.word_order, std::bit_cast<std::uint32_t>(static_cast<float>(value)), words);
      break;
  }
}

}  // namespace flexarm
