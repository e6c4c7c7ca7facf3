#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flexarm {

/// The word of `words` closest to `word`: at most one letter in three, rounded up, is wrong,
/// missing or added. Empty if no word is that close.
std::optional<std::string> ClosestWord(std::string_view word,
                                       const std::vector<std::string>& words);

}  // namespace flexarm
