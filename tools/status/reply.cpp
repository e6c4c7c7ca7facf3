#include "tools/status/reply.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace flexarm {
namespace {

constexpr std::size_t kMostBytes = 400;

const Reply kNull;
const Reply kEmptyList = Reply::array();

// Bytes that a terminal may obey, and those that are no text, become '?', the end of a line becomes
// a space. JSON is UTF-8 already.
std::string OneLine(const std::string& text) {
  std::string line = text.substr(0, kMostBytes);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const auto byte = static_cast<unsigned char>(line[i]);
    const auto next = i + 1 < line.size() ? static_cast<unsigned char>(line[i + 1]) : 0U;
    if (byte < 0x20 || byte == 0x7F) line[i] = byte == '\n' ? ' ' : '?';
    if (byte == 0xC2 && next >= 0x80 && next < 0xA0) line[i] = line[i + 1] = '?';
  }
  return line.size() < text.size() ? line + ".." : line;
}

}  // namespace

const Reply& In(const Reply& reply, const char* key) {
  if (!reply.is_object()) return kNull;
  const auto found = reply.find(key);
  return found == reply.end() ? kNull : *found;
}

const Reply& ListIn(const Reply& reply, const char* key) {
  const Reply& found = In(reply, key);
  return found.is_array() ? found : kEmptyList;
}

std::string TextOf(const Reply& value, const std::string& otherwise) {
  return value.is_string() ? OneLine(value.get<std::string>()) : otherwise;
}

std::string TextIn(const Reply& reply, const char* key, const std::string& otherwise) {
  return TextOf(In(reply, key), otherwise);
}

bool FlagIn(const Reply& reply, const char* key, bool otherwise) {
  const Reply& found = In(reply, key);
  return found.is_boolean() ? found.get<bool>() : otherwise;
}

double NumberIn(const Reply& reply, const char* key, double otherwise) {
  const Reply& found = In(reply, key);
  const double value = found.is_number() ? found.get<double>() : otherwise;
  return std::isfinite(value) ? value : otherwise;
}

double NumberOrNan(const Reply& value) {
  return value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::string FigureOf(const Reply& value, int decimals) {
  if (!value.is_number()) return "-";
  std::array<char, 64> text{};
  const double number = value.get<double>();
  const bool huge = std::fabs(number) >= 1e12;  // its digits would fill lines
  if (huge) std::snprintf(text.data(), text.size(), "%.*e", decimals, number);
  if (!huge) std::snprintf(text.data(), text.size(), "%.*f", decimals, number);
  return text.data();
}

std::string FigureIn(const Reply& reply, const char* key, int decimals) {
  return FigureOf(In(reply, key), decimals);
}

const Reply& Element(const Reply& list, std::size_t i) {
  return list.is_array() && i < list.size() ? list[i] : kNull;
}

}  // namespace flexarm
