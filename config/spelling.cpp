#include "config/spelling.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace flexarm {
namespace {

constexpr std::size_t kLongestWord = 64;  // bounds the time that a hostile file can take

// Levenshtein distance: the smallest number of insertions, deletions and replacements from a to b.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> ClosestWord(std::string_view word,
                                       const std::vector<std::string>& words) {
  if (word.size() > kLongestWord) return std::nullopt;
  std::size_t closest = (word.size() + 2) / 3 + 1;
  std::optional<std::string> found;
  for (const std::string& candidate : words) {
    const std::size_t distance = EditDistance(word, candidate);
    if (distance < closest) {
      closest = distance;
      found = candidate;
    }
  }
  return found;
}

}  // namespace flexarm
