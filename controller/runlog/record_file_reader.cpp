#include "controller/runlog/record_file_reader.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace flexarm {
namespace {

constexpr std::size_t kWindowBytes = 1 << 18;
// A file made to hurt has many beginnings of long records. Their checksums are not computed beyond
// this number of bytes.
constexpr std::uint64_t kSearchBudget = 1 << 28;

std::string ReadBytes(int fd, std::uint64_t offset, std::size_t length) {
  std::string bytes(length, '\0');
  std::size_t done = 0;
  while (done < length) {
    const ssize_t count =
        ::pread(fd, bytes.data() + done, length - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;  // cut shorter meanwhile, or an error: the record is torn
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace

RecordFileReader::RecordFileReader(int fd) : fd_(fd) {
  struct stat there{};
  if (::fstat(fd, &there) == 0) size_ = static_cast<std::uint64_t>(there.st_size);
  problem_ = RecordHeaderProblem(Window(0, kRecordHeaderBytes));
}

std::string_view RecordFileReader::Window(std::uint64_t offset, std::size_t length) {
  if (offset >= size_) return {};
  length = static_cast<std::size_t>(std::min<std::uint64_t>(length, size_ - offset));
  if (offset < window_at_ || offset + length > window_at_ + window_.size()) {
    const std::uint64_t wanted = std::max(length, kWindowBytes);
    window_ = ReadBytes(fd_, offset,
                        static_cast<std::size_t>(std::min<std::uint64_t>(wanted, size_ - offset)));
    window_at_ = offset;
  }
  return std::string_view(window_).substr(static_cast<std::size_t>(offset - window_at_), length);
}

std::optional<RunRecord> RecordFileReader::Next() {
  if (!problem_.empty() || ended_ || offset_ >= size_) return std::nullopt;
  std::uint64_t budget = kSearchBudget;
  if (IsWholeAt(offset_, &budget)) {
    const std::size_t length = DecodeFrame(Window(offset_, 8))->size();
    if (std::optional<RunRecord> record = DecodeRecord(Window(offset_, length))) {
      offset_ += length;
      return record;
    }
  }
  ended_ = true;
  if (HasWholeRecordAfter(offset_)) damaged_at_ = offset_;
  return std::nullopt;
}

bool RecordFileReader::IsWholeAt(std::uint64_t offset, std::uint64_t* budget) {
  const std::optional<RecordFrame> frame = DecodeFrame(Window(offset, 8));
  if (!frame || offset + frame->size() > size_ || frame->size() > *budget) return false;
  *budget -= frame->size();
  const std::string_view record = Window(offset, frame->size());
  return record.size() == frame->size() && RecordIsWhole(record, offset);
}

bool RecordFileReader::HasWholeRecordAfter(std::uint64_t offset) {
  std::uint64_t budget = kSearchBudget;
  for (std::uint64_t at = offset + 1; at + kRecordFrameBytes <= size_; ++at) {
    if (IsWholeAt(at, &budget)) return true;
  }
  return false;
}

}  // namespace flexarm
