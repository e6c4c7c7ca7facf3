#include "tools/status/styled_row.h"

#include <algorithm>

#include "tools/status/display_text.h"

namespace flexarm {
namespace {

// ECMA-48 sequences that every terminal with colours knows.
const char* Sequence(Look look) {
  switch (look) {
    case Look::kPlain:
      return "";
    case Look::kTitle:
      return "\033[1m";
    case Look::kGood:
      return "\033[36m";
    case Look::kCaution:
      return "\033[1;33m";
    case Look::kBad:
      return "\033[1;7m";
  }
  return "";
}

std::string Blanks(int columns) {
  std::string blanks(static_cast<std::size_t>(std::max(columns, 0)), ' ');
  return blanks;
}

}  // namespace

StyledRow& StyledRow::Add(std::string_view text, Look look) {
  if (text.empty()) return *this;
  if (!parts_.empty() && parts_.back().look == look) {
    parts_.back().text += text;
  } else {
    parts_.push_back({.text = std::string(text), .look = look});
  }
  width_ += DisplayWidth(text);
  return *this;
}

StyledRow& StyledRow::Add(const StyledRow& row) {
  for (const Part& part : row.parts_) Add(part.text, part.look);
  return *this;
}

StyledRow& StyledRow::PadTo(int columns) { return Add(Blanks(columns - width_)); }

std::string StyledRow::Text(int columns, const ScreenStyle& style) const {
  std::string text;
  int left = columns;
  for (const Part& part : parts_) {
    const std::string shown = Clipped(style.utf8 ? part.text : InAscii(part.text), left);
    const bool plain = !style.colour || part.look == Look::kPlain;
    text += plain ? shown : Sequence(part.look) + shown + "\033[0m";
    left -= DisplayWidth(shown);
    if (shown.size() < part.text.size() && style.utf8) break;  // cut: nothing may follow
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

Rows Flow(const Rows& items, int columns, int indent, int gap) {
  Rows rows;
  for (const StyledRow& item : items) {
    const bool fits = !rows.empty() && rows.back().width() + gap + item.width() <= columns;
    if (fits) {
      rows.back().Add(Blanks(gap)).Add(item);
    } else {
      StyledRow row;
      if (!rows.empty()) row.Add(Blanks(indent));
      rows.push_back(row.Add(item));
    }
  }
  return rows;
}

Rows WrapWords(std::string_view text, int columns) {
  Rows words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) words.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return Flow(words, columns, 0, 1);
}

}  // namespace flexarm
