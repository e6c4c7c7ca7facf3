#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "controller/runlog/record_format.h"

namespace flexarm {

/// Reads a record file in order, also while it grows: no further than its size at the beginning.
///
/// What a killed process or a full disk leaves is a torn last record. Bad bytes with whole records
/// behind them are damage.
class RecordFileReader {
 public:
  /// @param fd  open for reading; outlives the reader
  explicit RecordFileReader(int fd);

  /// Why nothing can be read: the file's header; "" if it can.
  const std::string& problem() const { return problem_; }

  /// The next record; empty at the end, at a torn record, and at damage.
  std::optional<RunRecord> Next();

  // Once Next gave nothing:

  /// Bytes behind the last whole record that was read. 0: the file ends with it.
  std::uint64_t left_out_bytes() const { return size_ > offset_ ? size_ - offset_ : 0; }
  /// Where the record with the damage begins; empty if nothing whole stands behind it: it is torn.
  std::optional<std::uint64_t> damaged_at() const { return damaged_at_; }

 private:
  /// The bytes of [offset, offset + length), fewer at the end; valid until the next call.
  std::string_view Window(std::uint64_t offset, std::size_t length);
  bool IsWholeAt(std::uint64_t offset, std::uint64_t* budget);
  bool HasWholeRecordAfter(std::uint64_t offset);

  int fd_;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = kRecordHeaderBytes;
  std::string problem_;
  std::string window_;
  std::uint64_t window_at_ = 0;
  bool ended_ = false;
  std::optional<std::uint64_t> damaged_at_;
};

}  // namespace flexarm
