// Blocks of records: nothing is lost, and nothing but a whole block is read.

#include "controller/runlog/record_blocks.h"

#include <algorithm>
#include <bit>

#include "controller/runlog/blob.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

std::vector<std::uint64_t> RandomWords(std::size_t count) {
  std::mt19937_64 random(7);
  std::vector<std::uint64_t> words(count);
  for (std::uint64_t& word : words) word = random();
  return words;
}

TEST(WordBlocks, AnyWordsComeBackWhateverTheyAreExpectedToBe) {
  const WordBlocks blocks({{.word = 3, .rows_before = 1},
                           {.word = 2, .rows_before = 2},
                           {.word = 2, .rows_before = 1, .is_smooth = true},
                           {.word = 3, .rows_before = 1}});
  for (const std::size_t rows : {1U, 2U, 3U, 4U, 5U, 1000U}) {
    std::vector<std::uint64_t> words = RandomWords(4 * rows);
    words[0] = std::bit_cast<std::uint64_t>(-0.0);
    words[1] = ~std::uint64_t{0};
    for (const Packing packing : {Packing::kFast, Packing::kSmall}) {
      const std::string packed = blocks.Pack(words, packing);
      std::vector<std::uint64_t> unpacked(words.size());
      ASSERT_TRUE(blocks.Unpack(packed, unpacked));
      EXPECT_EQ(unpacked, words);
    }
  }
}

// What is expected costs nothing: a parabola, and a word that follows another.
TEST(WordBlocks, WhatIsAsExpectedPacksToNearlyNothing) {
  const WordBlocks blocks(
      {{.word = 1, .rows_before = 2}, {.word = 1, .rows_before = 1, .is_smooth = true}});
  constexpr std::size_t kRows = 1000;
  std::vector<std::uint64_t> words(2 * kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    words[2 * row + 1] = 1'000'000'000'000 + 977 * row * row;
    if (row >= 2) words[2 * row] = words[2 * (row - 2) + 1];
  }
  EXPECT_LT(blocks.Pack(words, Packing::kFast).size(), 100U);
}

TEST(WordBlocks, ABlockOfAnotherNumberOfRowsIsRefused) {
  const WordBlocks blocks({{.word = 0, .rows_before = 1}});
  const std::vector<std::uint64_t> words = RandomWords(10);
  const std::string packed = blocks.Pack(words, Packing::kFast);
  for (const std::size_t rows : {9U, 11U}) {
    std::vector<std::uint64_t> unpacked(rows);
    EXPECT_FALSE(blocks.Unpack(packed, unpacked)) << rows;
  }
  std::vector<std::uint64_t> unpacked(10);
  EXPECT_FALSE(blocks.Unpack(packed.substr(0, packed.size() - 1), unpacked));
}

TEST(RecordBlocks, TicksComeBackToTheBitButForWhatIsNotKept) {
  std::vector<TickRecord> ticks;
  for (int tick = 1; tick <= 50; ++tick) ticks.push_back(MakeTick(tick));
  ticks[3].truth.known = false;
  ticks[4].gate_reasons = 0b10010;
  ticks[5].output.torque_nm = {-0.0, std::numeric_limits<double>::quiet_NaN()};
  std::vector<TickRecord> read;
  ASSERT_EQ(UnpackTicks(PackTicks(ticks, Packing::kSmall), &read), "");
  ASSERT_EQ(read.size(), ticks.size());
  for (std::size_t n = 0; n < ticks.size(); ++n) {
    EXPECT_TRUE(SameBytes(read[n].input, ticks[n].input)) << n;
    EXPECT_TRUE(IsOutputOf(read[n], ticks[n].output)) << n;
    EXPECT_EQ(read[n].output.x_hat, ticks[n].output.x_hat);
    EXPECT_EQ(read[n].gate_reasons, ticks[n].gate_reasons);
    EXPECT_EQ(read[n].truth.known, n != 3);
    if (n == 3) continue;
    EXPECT_EQ(read[n].truth.tip_deflection_m, ticks[n].truth.tip_deflection_m);
  }
}

// Every byte of the structs may change between two samples, also those that follow another.
TEST(RecordBlocks, TicksOfAnyBytesComeBack) {
  std::vector<TickRecord> ticks(20);
  std::mt19937 random(3);
  for (TickRecord& tick : ticks) {
    std::vector<unsigned char> bytes(sizeof tick.input + sizeof tick.output);
    std::ranges::generate(bytes, [&] { return static_cast<unsigned char>(random()); });
    std::memcpy(&tick.input, bytes.data(), sizeof tick.input);
    std::memcpy(&tick.output, bytes.data() + sizeof tick.input, sizeof tick.output);
  }
  std::vector<TickRecord> read;
  ASSERT_EQ(UnpackTicks(PackTicks(ticks, Packing::kFast), &read), "");
  for (std::size_t n = 0; n < ticks.size(); ++n) {
    EXPECT_TRUE(SameBytes(read.at(n).input, ticks[n].input)) << n;
    EXPECT_TRUE(IsOutputOf(read.at(n), ticks[n].output)) << n;
  }
}

// Also of what a block does not keep, and when a record is packed again.
TEST(RecordBlocks, NoOtherOutputPassesForTheRecordedOne) {
  TickRecord whole = MakeTick(1);
  whole.output.x_next[11] = 0.25;
  whole.output.innovation[7] = 0.125;
  std::vector<TickRecord> read, again;
  ASSERT_EQ(UnpackTicks(PackTicks({{whole}}, Packing::kFast), &read), "");
  ASSERT_EQ(UnpackTicks(PackTicks(read, Packing::kSmall), &again), "");
  std::array<unsigned char, sizeof whole.output> bytes;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::memcpy(bytes.data(), &whole.output, sizeof bytes);
    bytes[at] ^= 1;
    StepOutput other;
    std::memcpy(&other, bytes.data(), sizeof other);
    for (const TickRecord& record : {whole, read.at(0), again.at(0)}) {
      ASSERT_TRUE(IsOutputOf(record, whole.output));
      ASSERT_FALSE(IsOutputOf(record, other)) << "byte " << at;
    }
  }
}

TEST(RecordBlocks, TimingsComeBack) {
  std::vector<TimingRecord> timings;
  for (int i = 0; i < 20; ++i) {
    timings.push_back({.tick = i, .due_ns = 20 * i, .woke_ns = 20 * i + i % 3, .finished_ns = -i});
  }
  std::vector<TimingRecord> read;
  ASSERT_EQ(UnpackTimings(PackTimings(timings, Packing::kFast), &read), "");
  ASSERT_EQ(read.size(), timings.size());
  for (std::size_t n = 0; n < read.size(); ++n) EXPECT_TRUE(SameBytes(read[n], timings[n])) << n;
}

}  // namespace
}  // namespace flexarm
