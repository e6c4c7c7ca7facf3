#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flexarm {

/// How much time a block may take to pack: a few microseconds a row, or twice that for 1 % less.
enum class Packing { kFast, kSmall };

/// Predictor of a word: the word `word` of the row `rows_before` rows earlier, or, if it is smooth,
/// the parabola through its own last three values.
struct WordSource {
  std::size_t word;
  std::size_t rows_before;  ///< at least 1
  bool is_smooth = false;   ///< then `word` is the word itself, and rows_before 1
};

/// Packs rows of 64-bit words into blocks, without loss. A block is unpacked by itself.
///
/// Delta coding: a word is stored as the difference from its prediction, both as integers, with the
/// sign in the lowest bit, so that small differences have upper bytes of zero. The bytes of one
/// significance of all rows stand together (byte transposition), and zstd compresses them.
class WordBlocks {
 public:
  /// @param sources  the predictor of each word of a row. It uses the same word or one that stands
  ///                 later in the row, because Unpack decodes a row from its last word to its
  ///                 first.
  explicit WordBlocks(std::vector<WordSource> sources) : sources_(std::move(sources)) {}

  std::size_t words_per_row() const { return sources_.size(); }
  /// @param words  whole rows, one after the other
  std::string Pack(std::span<const std::uint64_t> words, Packing packing) const;
  /// @param words  has the size of the rows that the block must hold
  /// @returns false if the bytes are no block of so many rows
  [[nodiscard]] bool Unpack(std::string_view bytes, std::span<std::uint64_t> words) const;

 private:
  std::vector<WordSource> sources_;
};

}  // namespace flexarm
