#include "controller/files/utf8.h"

namespace flexarm {
namespace {

// The second byte's range is narrower after some first bytes: RFC 3629, section 4.
struct Lead {
  std::size_t length;
  unsigned char second_from, second_to;
};

Lead LeadOf(unsigned char c) {
  if (c < 0x80) return {.length = 1, .second_from = 0, .second_to = 0};
  if (c >= 0xC2 && c <= 0xDF) return {.length = 2, .second_from = 0x80, .second_to = 0xBF};
  if (c == 0xE0) return {.length = 3, .second_from = 0xA0, .second_to = 0xBF};
  if (c == 0xED) return {.length = 3, .second_from = 0x80, .second_to = 0x9F};
  if (c >= 0xE1 && c <= 0xEF) return {.length = 3, .second_from = 0x80, .second_to = 0xBF};
  if (c == 0xF0) return {.length = 4, .second_from = 0x90, .second_to = 0xBF};
  if (c >= 0xF1 && c <= 0xF3) return {.length = 4, .second_from = 0x80, .second_to = 0xBF};
  if (c == 0xF4) return {.length = 4, .second_from = 0x80, .second_to = 0x8F};
  return {.length = 0, .second_from = 0, .second_to = 0};
}

}  // namespace

std::size_t Utf8Length(std::string_view text) {
  if (text.empty()) return 0;
  const Lead lead = LeadOf(static_cast<unsigned char>(text[0]));
  if (lead.length > text.size()) return 0;
  for (std::size_t i = 1; i < lead.length; ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    const unsigned char from = i == 1 ? lead.second_from : 0x80;
    const unsigned char to = i == 1 ? lead.second_to : 0xBF;
    if (c < from || c > to) return 0;
  }
  return lead.length;
}

}  // namespace flexarm
