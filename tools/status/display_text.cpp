#include "tools/status/display_text.h"

#include <algorithm>
#include <clocale>
#include <cwchar>

namespace flexarm {
namespace {

/// The calling thread knows UTF-8 until the end of this object.
class Utf8Locale {
 public:
  Utf8Locale() : before_(uselocale(Shared())) {}
  ~Utf8Locale() { uselocale(before_); }
  Utf8Locale(const Utf8Locale&) = delete;
  Utf8Locale& operator=(const Utf8Locale&) = delete;

 private:
  // Of the process. Null where the C library has no such locale: the thread keeps its own.
  static locale_t Shared() {
    static const locale_t shared = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
    return shared;
  }

  locale_t before_;
};

struct Sign {
  std::size_t bytes;
  int columns;
};

// The sign with which a text begins, which is not empty.
Sign FirstSign(std::string_view text) {
  wchar_t code = 0;
  std::mbstate_t state{};
  const std::size_t bytes = std::mbrtowc(&code, text.data(), text.size(), &state);
  constexpr std::size_t kLongest = 4;  // more says that the bytes are no sign, or half of one
  if (bytes == 0 || bytes > kLongest) return {.bytes = 1, .columns = 1};
  return {.bytes = bytes, .columns = std::max(wcwidth(code), 0)};
}

}  // namespace

int DisplayWidth(std::string_view text) {
  const Utf8Locale utf8;
  int columns = 0;
  while (!text.empty()) {
    const Sign sign = FirstSign(text);
    columns += sign.columns;
    text.remove_prefix(sign.bytes);
  }
  return columns;
}

std::string Clipped(std::string_view text, int columns) {
  const Utf8Locale utf8;
  std::size_t kept = 0;
  int taken = 0;
  while (kept < text.size()) {
    const Sign sign = FirstSign(text.substr(kept));
    taken += sign.columns;
    if (taken > columns) break;
    kept += sign.bytes;
  }
  return std::string(text.substr(0, kept));
}

std::string InAscii(std::string_view text) {
  const Utf8Locale utf8;
  std::string ascii;
  while (!text.empty()) {
    const Sign sign = FirstSign(text);
    const bool plain = static_cast<unsigned char>(text.front()) < 0x80;
    ascii += plain ? std::string(1, text.front())
                   : std::string(static_cast<std::size_t>(sign.columns), '?');
    text.remove_prefix(sign.bytes);
  }
  return ascii;
}

}  // namespace flexarm
