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

/// What a word is expected to be: another one of `rows_before` rows before it; or, if it is
/// smooth, what the parabola through its own last three values gives.
struct WordSource {
  std::size_t word;
  std::size_t rows_before;  ///< at least 1
  bool is_smooth = false;   ///< then `word` is the word itself, and rows_before 1
};

/// Packs rows of 64-bit words into blocks, without loss. A block is unpacked by itself.
///
/// A word is stored as its difference from what it is expected to be, both as integers; the
/// sign is the lowest bit. So what is as expected is zero, and so are the upper bytes of what is
/// near. The bytes of one significance of all rows stand together, which makes the zeros long, and
/// zstd packs them.
class WordBlocks {
 public:
  /// @param sources  one for each word of a row. A source is the word itself or a later one: words
  ///                 are unpacked from the last to the first.
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
