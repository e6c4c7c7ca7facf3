#include <cstring>
#include <string>
#include <string_view>

#include "controller/files/input_error.h"
#include "controller/runlog/checksum.h"
#include "controller/runlog/record_blocks.h"
#include "controller/runlog/record_format.h"
#include "controller/runlog/run_reader.h"
#include "controller/runlog/run_recovery.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {
namespace {

// The same with the right header and checksums: a hostile program can compute them, and without
// them nothing behind them is read.
std::string WithChecksums(std::string bytes) {
  if (!bytes.starts_with(kRecordMagic) || bytes.size() < kRecordHeaderBytes) return bytes;
  bytes.replace(0, kRecordHeaderBytes, RecordHeader());
  constexpr std::size_t kSum = sizeof(std::uint64_t);
  for (std::size_t at = kRecordHeaderBytes; at < bytes.size();) {
    const auto frame = DecodeFrame(std::string_view(bytes).substr(at));
    if (!frame || frame->size() > bytes.size() - at) break;
    const std::size_t body = frame->size() - kSum;
    const std::uint64_t sum = Checksum64(std::string_view(bytes).substr(at, body), at);
    std::memcpy(bytes.data() + at + body, &sum, kSum);
    at += frame->size();
  }
  return bytes;
}

void ReadBlocks(std::string_view bytes) {
  std::vector<TickRecord> ticks;
  UnpackTicks(bytes, &ticks);
  std::vector<TimingRecord> timings;
  UnpackTimings(bytes, &timings);
}

}  // namespace

// As a run log, which is read and recovered, and as the block of a log's table.
void FuzzLog(FuzzBytes input) {
  static const FuzzFile file("input.flexarm");
  const std::string bytes = WithChecksums(TextOf(input));
  ReadBlocks(bytes);
  file.Write(bytes);
  try {
    RunReader reader(file.path());
    reader.DigestHolds();
    reader.ReadAll();
  } catch (const InputError&) {
  }
  RecoverRun(file.path());
}

}  // namespace flexarm
