#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "controller/realtime/timing_record.h"
#include "controller/safety/safety_record.h"
#include "controller/types/records.h"

namespace flexarm {

// The record file: a run while it is written. It only grows, and every record has a checksum, so
// what a killed process leaves is a run up to its last whole record.
//
//   header  8 bytes "FlexRec\n", u32 format version, u32 versions of StepInput, StepOutput and
//           SafetyRecord, u64 checksum of the bytes before it
//   record  u32 kind, u32 length of the payload, payload, u64 checksum of the bytes before it
//
// Numbers are little-endian. A checksum is XXH3-64 with the record's offset in the file as its
// seed: bytes that belong elsewhere do not pass.

inline constexpr std::string_view kRecordMagic("FlexRec\n", 8);  ///< the first bytes
inline constexpr std::uint32_t kRecordFormatVersion = 2;
inline constexpr std::size_t kRecordHeaderBytes = 8 + 4 * 4 + 8;
inline constexpr std::size_t kRecordFrameBytes = 4 + 4 + 8;  ///< of a record, beside its payload
inline constexpr std::size_t kLargestPayload = 16 << 20;     ///< bytes; configs have kilobytes

/// A key of table `run`. The last one of a key holds.
struct InfoRecord {
  std::string key, value;
};

/// The run was ended in order. Nothing follows.
struct EndRecord {
  std::string result_json;
};

/// The samples of one commit, 1 to kLargestBlock.
struct TicksRecord {
  std::vector<TickRecord> ticks;
};

/// The activations of the control task of one commit, 1 to kLargestBlock.
struct TimingsRecord {
  std::vector<TimingRecord> timings;
};

using RunRecord =
    std::variant<InfoRecord, TicksRecord, TimingsRecord, SafetyRecord, RunEvent, EndRecord>;

/// The header of a record file of this build.
std::string RecordHeader();

/// What is wrong with the header in the first bytes of a file; "" if this build reads the file.
std::string RecordHeaderProblem(std::string_view bytes);

/// The record as it stands at `offset` of a record file. Ticks and timings are blocks of
/// record_blocks.h.
std::string EncodeRecord(const RunRecord& record, std::uint64_t offset);

/// The kind and the length that a record begins with.
struct RecordFrame {
  std::uint32_t kind;
  std::uint32_t payload_bytes;

  std::size_t size() const { return kRecordFrameBytes + payload_bytes; }
};

/// Empty if no record begins with these 8 bytes.
std::optional<RecordFrame> DecodeFrame(std::string_view bytes);

/// True if the checksum of a whole record is right.
bool RecordIsWhole(std::string_view record, std::uint64_t offset);

/// The content of a whole record; empty if it is of no known layout.
std::optional<RunRecord> DecodeRecord(std::string_view record);

}  // namespace flexarm
