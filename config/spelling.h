#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flexarm {

/// The word of `words` that `word` was probably meant to be: at most one letter in three, rounded
/// up, is wrong, missing or too many. Nothing if none is that close.
std::optional<std::string> ClosestWord(std::string_view word,
                                       const std::vector<std::string>& words);

}  // namespace flexarm
