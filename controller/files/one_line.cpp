#include "controller/files/one_line.h"

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

namespace flexarm {
namespace {

// The code point at `*at`, which moves behind it; nothing if the bytes there are not UTF-8.
std::optional<char32_t> NextCodePoint(const std::string& text, std::size_t* at) {
  const auto byte = [&text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(*at);
  const auto length = static_cast<std::size_t>(std::countl_one(first));
  if (length == 0) {
    ++*at;
    return first;
  }
  if (length < 2 || length > 4 || *at + length > text.size()) return std::nullopt;
  char32_t code = first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(*at + i) & 0xC0u) != 0x80u) return std::nullopt;
    code = (code << 6) | (byte(*at + i) & 0x3Fu);
  }
  constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[length] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) {
    return std::nullopt;
  }
  *at += length;
  return code;
}

// Ends a line, moves the cursor, or changes how the text around it is shown.
bool IsControl(char32_t code) {
  const auto within = [code](char32_t first, char32_t last) {
    return code >= first && code <= last;
  };
  return code < 0x20 || within(0x7F, 0x9F) || within(0x200B, 0x200F) || within(0x2028, 0x202E) ||
         within(0x2060, 0x206F) || code == 0xFEFF;
}

}  // namespace

std::string ProblemOfLine(const std::string& text, std::size_t most_bytes) {
  if (text.size() > most_bytes) return "is longer than " + std::to_string(most_bytes) + " bytes";
  bool visible = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::optional<char32_t> code = NextCodePoint(text, &at);
    if (!code) return "is not UTF-8";
    if (IsControl(*code)) return "contains a control character";
    visible = visible || (*code != ' ' && *code != 0xA0);
  }
  return visible ? "" : "is empty";
}

}  // namespace flexarm
