#include "controller/runlog/word_blocks.h"

#include <zstd.h>

#include <stdexcept>

namespace flexarm {
namespace {

constexpr std::size_t kWordBytes = sizeof(std::uint64_t);

int LevelOf(Packing packing) { return packing == Packing::kFast ? 3 : 9; }

// The sign is the lowest bit: small differences of either sign have upper bytes of zero.
std::uint64_t Folded(std::uint64_t difference) {
  return difference << 1 ^ (0 - (difference >> 63));
}
// Prediction of a word from earlier rows of its block. Doubles of one exponent differ as their bits
// do, as integers; all sums wrap around, so that a bad prediction costs bytes, not correctness.
std::uint64_t Predicted(std::span<const std::uint64_t> words, std::size_t width, std::size_t row,
                        const WordSource& source) {
  if (row < source.rows_before) return 0;
  const auto before = [&](std::size_t rows) { return words[(row - rows) * width + source.word]; };
  if (!source.is_smooth || row < 3) return before(source.rows_before);
  return 3 * (before(1) - before(2)) + before(3);
}

std::uint64_t Unfolded(std::uint64_t folded) { return folded >> 1 ^ (0 - (folded & 1)); }

}  // namespace

std::string WordBlocks::Pack(std::span<const std::uint64_t> words, Packing packing) const {
  const std::size_t width = sources_.size(), rows = words.size() / width;
  std::string planes(rows * width * kWordBytes, '\0');
  for (std::size_t word = 0; word < width; ++word) {
    const WordSource& source = sources_[word];
    char* plane = planes.data() + word * kWordBytes * rows;
    for (std::size_t row = 0; row < rows; ++row) {
      const std::uint64_t folded =
          Folded(words[row * width + word] - Predicted(words, width, row, source));
      for (std::size_t byte = 0; byte < kWordBytes; ++byte) {
        plane[byte * rows + row] = static_cast<char>(folded >> (8 * byte));
      }
    }
  }
  std::string packed(ZSTD_compressBound(planes.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), planes.data(), planes.size(), LevelOf(packing));
  if (ZSTD_isError(size) != 0) throw std::runtime_error(ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

bool WordBlocks::Unpack(std::string_view bytes, std::span<std::uint64_t> words) const {
  const std::size_t width = sources_.size(), rows = words.size() / width;
  std::string planes(words.size_bytes(), '\0');
  const std::size_t size =
      ZSTD_decompress(planes.data(), planes.size(), bytes.data(), bytes.size());
  if (size != planes.size()) return false;  // also an error
  for (std::size_t word = width; word-- > 0;) {
    const WordSource& source = sources_[word];
    const char* plane = planes.data() + word * kWordBytes * rows;
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint64_t folded = 0;
      for (std::size_t byte = 0; byte < kWordBytes; ++byte) {
        folded |= std::uint64_t{static_cast<unsigned char>(plane[byte * rows + row])} << (8 * byte);
      }
      words[row * width + word] = Unfolded(folded) + Predicted(words, width, row, source);
    }
  }
  return true;
}

}  // namespace flexarm
