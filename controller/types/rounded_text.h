#pragma once

#include <array>
#include <charconv>
#include <string>

namespace flexarm {

/// Formats a number for a message, rounded: "1.37", "1.9e+03". Allocates: start-up only.
/// @param digits  significant digits, or with `fixed` digits after the decimal point
inline std::string RoundedText(double value, int digits, bool fixed = false) {
  std::array<char, 64> text{};
  const auto format = fixed ? std::chars_format::fixed : std::chars_format::general;
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value, format, digits);
  return {text.data(), end};
}

}  // namespace flexarm
