#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/word_blocks.h"
#include "controller/types/records.h"

namespace flexarm {

// Records of a run as blocks (word_blocks.h): what the control task tells each period. They read
// back to the bit, but for TickRecord::run_number, a truth that is not known, and two parts of the
// output: x_next and innovation, a third of all bytes, which no reader uses and which replay
// computes again. Of these a checksum is kept, so that a replay can tell whether it has every bit
// of them.

inline constexpr std::size_t kLargestBlock = 1024;  ///< records

/// @param records  1 to kLargestBlock
std::string PackTicks(std::span<const TickRecord> records, Packing packing);
std::string PackTimings(std::span<const TimingRecord> records, Packing packing);

/// True if `output` is what the record's step gave, to the bit.
bool IsOutputOf(const TickRecord& record, const StepOutput& output);

// @returns the error in the bytes; empty if none, and only then `records` is set
std::string UnpackTicks(std::string_view bytes, std::vector<TickRecord>* records);
std::string UnpackTimings(std::string_view bytes, std::vector<TimingRecord>* records);

}  // namespace flexarm
