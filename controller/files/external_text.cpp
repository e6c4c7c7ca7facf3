#include "controller/files/external_text.h"

#include "controller/files/utf8.h"

namespace flexarm {
namespace {

// Three bytes from `from` to `to`, as UTF-8 orders them.
bool Between(std::string_view character, std::string_view from, std::string_view to) {
  return character >= from && character <= to;
}

// Whether a terminal would do something else than show it.
bool IsControl(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7F;
  if (character.size() == 2) return Between(character, "\xC2\x80", "\xC2\x9F");
  return Between(character, "\xE2\x80\xA8", "\xE2\x80\xAE") ||
         Between(character, "\xE2\x81\xA6", "\xE2\x81\xA9");
}

std::string Escape(std::string_view bytes) {
  if (bytes == "\n") return "\\n";
  if (bytes == "\t") return "\\t";
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const char byte : bytes) {
    const auto value = static_cast<unsigned char>(byte);
    text += "\\x";
    text += kDigits[value >> 4U];
    text += kDigits[value & 15U];
  }
  return text;
}

}  // namespace

std::string Shown(std::string_view text, std::size_t most_bytes) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = Utf8Length(text);
    const std::string_view character = text.substr(0, length == 0 ? 1 : length);
    const bool plain = length != 0 && !IsControl(character);
    const std::string next = plain ? std::string(character) : Escape(character);
    if (shown.size() + next.size() > most_bytes) return shown + "...";
    shown += next;
    text.remove_prefix(character.size());
  }
  return shown;
}

std::string ShownMessage(std::string_view message) {
  std::string shown;
  while (true) {
    const std::size_t end = message.find('\n');
    shown += Shown(message.substr(0, end), kMessageBytes);
    if (end == std::string_view::npos) return shown;
    shown += '\n';
    message.remove_prefix(end + 1);
  }
}

}  // namespace flexarm
