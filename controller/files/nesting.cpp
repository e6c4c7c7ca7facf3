#include "controller/files/nesting.h"

#include <algorithm>
#include <cstddef>

namespace flexarm {
namespace {

// Position behind the string that starts at `at`. Strings of one line end at the line's end at the
// latest: the parser reports those that are not closed.
std::size_t BehindString(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view three = text.substr(at, 3);
  const bool long_string = three.size() == 3 && three[1] == quote && three[2] == quote;
  std::size_t i = at + (long_string ? 3 : 1);
  while (i < text.size()) {
    if (text[i] == '\\' && quote == '"') {
      i += 2;
    } else if (long_string ? text.substr(i, 3) == three : text[i] == quote) {
      return i + (long_string ? 3 : 1);
    } else if (text[i] == '\n' && !long_string) {
      return i;
    } else {
      ++i;
    }
  }
  return text.size();
}

int LineOf(std::string_view text, std::size_t at) {
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
}

std::size_t BehindJsonString(std::string_view text, std::size_t at) {
  for (std::size_t i = at + 1; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
    } else if (text[i] == '"') {
      return i + 1;
    }
  }
  return text.size();
}

}  // namespace

int LineNestedTooDeepJson(std::string_view text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"') {
      i = BehindJsonString(text, i);
      continue;
    }
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepestNesting) return LineOf(text, i);
    ++i;
  }
  return 0;
}

int LineNestedTooDeepToml(std::string_view text) {
  int depth = 0;
  int dots = 0;  // of one key: a number has one, so the next separator ends the count
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = BehindString(text, i);
      continue;
    }
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      continue;
    }
    if (c == '.') ++dots;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (c == ',' || c == '=' || c == '\n' || c == '[' || c == '{') dots = 0;
    if (depth + dots > kDeepestNesting) return LineOf(text, i);
    ++i;
  }
  return 0;
}

}  // namespace flexarm
