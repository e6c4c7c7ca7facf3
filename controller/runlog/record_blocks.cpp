#include "controller/runlog/record_blocks.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "controller/runlog/blob.h"
#include "controller/runlog/checksum.h"

namespace flexarm {
namespace {

// A TickRecord as it is packed.
struct TickRow {
  StepInput input;
  StepOutput output;  // Kept()
  std::uint64_t output_checksum;
  std::uint32_t gate_reasons;
  std::uint32_t truth_known;
  std::array<double, 2> hub_angle_rad, tip_m, tip_deflection_m;
};
static_assert(sizeof(TickRow) == sizeof(StepInput) + sizeof(StepOutput) + 16 + 6 * sizeof(double),
              "no padding: its words are packed");

// Stands before the packed bytes of a block.
struct BlockHeader {
  std::uint32_t records;
  std::uint32_t first_version, second_version;  // of the structs in a row; 0: it has none
};

constexpr std::size_t kWord = sizeof(std::uint64_t);

template <typename Row>
std::vector<WordSource> RowBefore() {
  static_assert(std::is_trivially_copyable_v<Row> && sizeof(Row) % kWord == 0);
  std::vector<WordSource> sources;
  for (std::size_t word = 0; word < sizeof(Row) / kWord; ++word) {
    sources.push_back({.word = word, .rows_before = 1});
  }
  return sources;
}

// What one sample computes, the next one or the one after gets as its input. References are smooth.
std::vector<WordSource> TickSources() {
  std::vector<WordSource> sources = RowBefore<TickRow>();
  const auto repeats = [&sources](std::size_t bytes, std::size_t to, std::size_t from,
                                  std::size_t rows_before) {
    for (std::size_t at = 0; at < bytes; at += kWord) {
      sources[(to + at) / kWord] = {.word = (from + at) / kWord, .rows_before = rows_before};
    }
  };
  const auto smooth = [&sources](std::size_t from, std::size_t to) {
    for (std::size_t at = from; at < to; at += kWord) sources[at / kWord].is_smooth = true;
  };
  constexpr std::size_t kOutput = offsetof(TickRow, output);
  smooth(offsetof(StepInput, reference_next), offsetof(StepInput, plan));
  repeats(sizeof(ReferenceSample), offsetof(StepInput, reference_now),
          offsetof(StepInput, reference_next), 1);
  repeats(2 * sizeof(RigidPoint), offsetof(StepInput, path),
          offsetof(StepInput, path) + sizeof(RigidPoint), 1);
  repeats(sizeof(StepInput::counts_before), offsetof(StepInput, counts_before),
          kOutput + offsetof(StepOutput, counts), 1);
  // A torque acts from the next sample on, and is a mean over that period in the one after.
  repeats(sizeof(StepInput::applied_torque_nm), offsetof(StepInput, applied_torque_nm),
          kOutput + offsetof(StepOutput, torque_nm), 2);
  return sources;
}

const WordBlocks& TickBlocks() {
  static const WordBlocks blocks(TickSources());
  return blocks;
}

const WordBlocks& TimingBlocks() {
  static const WordBlocks blocks(RowBefore<TimingRecord>());
  return blocks;
}

StepOutput Kept(const StepOutput& output) {
  StepOutput kept = output;
  kept.x_next.fill(0);
  kept.innovation.fill(0);
  return kept;
}

// Never 0, which stands for a whole output.
std::uint64_t ChecksumOf(const StepOutput& output) {
  std::array<char, sizeof output> bytes;
  std::memcpy(bytes.data(), &output, sizeof output);
  const std::uint64_t checksum = Checksum64({bytes.data(), bytes.size()}, 0);
  return checksum == 0 ? 1 : checksum;
}

TickRow RowOf(const TickRecord& record) {
  TickRow row{};
  row.input = record.input;
  row.output = Kept(record.output);
  row.output_checksum =
      record.output_checksum == 0 ? ChecksumOf(record.output) : record.output_checksum;
  row.gate_reasons = record.gate_reasons;
  row.truth_known = record.truth.known ? 1 : 0;
  if (!record.truth.known) return row;
  row.hub_angle_rad = record.truth.hub_angle_rad;
  row.tip_m = record.truth.tip_m;
  row.tip_deflection_m = record.truth.tip_deflection_m;
  return row;
}

TickRecord RecordOf(const TickRow& row) {
  return {.input = row.input,
          .output = row.output,
          .gate_reasons = row.gate_reasons,
          .run_number = 0,
          .truth = {.hub_angle_rad = row.hub_angle_rad,
                    .tip_m = row.tip_m,
                    .tip_deflection_m = row.tip_deflection_m,
                    .known = row.truth_known != 0},
          .output_checksum = row.output_checksum};
}

TimingRecord RowOf(const TimingRecord& record) { return record; }
TimingRecord RecordOf(const TimingRecord& row) { return row; }

template <typename Row, typename Record>
std::string Packed(const WordBlocks& blocks, BlockHeader header, std::span<const Record> records,
                   Packing packing) {
  header.records = static_cast<std::uint32_t>(records.size());
  std::vector<std::uint64_t> words(records.size() * blocks.words_per_row());
  std::uint64_t* to = words.data();
  for (const Record& record : records) {
    const Row row = RowOf(record);
    std::memcpy(to, &row, sizeof row);
    to += blocks.words_per_row();
  }
  std::string bytes(sizeof header, '\0');
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes + blocks.Pack(words, packing);
}

std::string VersionProblem(const char* what, std::uint32_t found, std::uint32_t expected) {
  if (found == expected) return {};
  return std::string("has ") + what + " of version " + std::to_string(found) + ", expected " +
         std::to_string(expected);
}

template <typename Row, typename Record>
std::string Unpacked(const WordBlocks& blocks, std::string_view bytes, const BlockHeader& expected,
                     std::vector<Record>* records) {
  BlockHeader header;
  if (bytes.size() < sizeof header) return "is cut short";
  std::memcpy(&header, bytes.data(), sizeof header);
  std::string problem = VersionProblem("inputs", header.first_version, expected.first_version);
  if (problem.empty()) {
    problem = VersionProblem("outputs", header.second_version, expected.second_version);
  }
  if (!problem.empty()) return problem;
  if (header.records == 0 || header.records > kLargestBlock) {
    return "has " + std::to_string(header.records) + " records, expected 1 to " +
           std::to_string(kLargestBlock);
  }
  std::vector<std::uint64_t> words(header.records * blocks.words_per_row());
  if (!blocks.Unpack(bytes.substr(sizeof header), words)) {
    return "is damaged: expected " + std::to_string(header.records) + " packed records";
  }
  records->clear();
  const std::uint64_t* from = words.data();
  for (std::uint32_t n = 0; n < header.records; ++n, from += blocks.words_per_row()) {
    Row row;
    std::memcpy(&row, from, sizeof row);
    records->push_back(RecordOf(row));
  }
  return {};
}

constexpr BlockHeader kTickHeader{
    .records = 0, .first_version = kStepInputVersion, .second_version = kStepOutputVersion};
constexpr BlockHeader kTimingHeader{.records = 0, .first_version = 0, .second_version = 0};

}  // namespace

bool IsOutputOf(const TickRecord& record, const StepOutput& output) {
  if (record.output_checksum == 0) return SameBytes(output, record.output);
  return ChecksumOf(output) == record.output_checksum && SameBytes(Kept(output), record.output);
}

std::string PackTicks(std::span<const TickRecord> records, Packing packing) {
  return Packed<TickRow>(TickBlocks(), kTickHeader, records, packing);
}

std::string PackTimings(std::span<const TimingRecord> records, Packing packing) {
  return Packed<TimingRecord>(TimingBlocks(), kTimingHeader, records, packing);
}

std::string UnpackTicks(std::string_view bytes, std::vector<TickRecord>* records) {
  return Unpacked<TickRow>(TickBlocks(), bytes, kTickHeader, records);
}

std::string UnpackTimings(std::string_view bytes, std::vector<TimingRecord>* records) {
  return Unpacked<TimingRecord>(TimingBlocks(), bytes, kTimingHeader, records);
}

}  // namespace flexarm
