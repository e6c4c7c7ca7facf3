#pragma once

#include <cstdint>
#include <optional>

#include "hal/modbus/modbus_config.h"

namespace flexarm {

/// Counts of a strain row from its registers, in the order of their addresses.
///
/// Empty if the value is not finite or the counts do not fit into 32 bits: a broken amplifier.
/// Rounds halves away from zero. Real-time: safe.
std::optional<std::int32_t> CountsFromWords(const ModbusRegister& row,
                                            const std::uint16_t* words) noexcept;

/// The inverse, for the simulated amplifier: clips at the ends of the type, as an amplifier does.
/// @param words  WidthOf(row.type) registers are written
void WordsFromCounts(const ModbusRegister& row, std::int32_t counts, std::uint16_t* words) noexcept;

}  // namespace flexarm
