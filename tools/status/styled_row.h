#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace flexarm {

/// What a part of a screen says. No look says it alone: the text does, too, for readers who see no
/// colours. Blue-green, yellow and inverse differ for every kind of colour blindness.
enum class Look : std::uint8_t {
  kPlain,
  kTitle,    ///< bold
  kGood,     ///< cyan
  kCaution,  ///< yellow, bold
  kBad,      ///< inverse, bold
};

/// What the terminal can show.
struct ScreenStyle {
  bool colour = true;
  bool utf8 = true;  ///< false: ASCII only
};

/// A row of a screen: parts of text, each with its look.
class StyledRow {
 public:
  StyledRow() = default;
  explicit StyledRow(std::string_view text, Look look = Look::kPlain) { Add(text, look); }

  StyledRow& Add(std::string_view text, Look look = Look::kPlain);
  StyledRow& Add(const StyledRow& row);
  /// Blanks up to a column; nothing if the row is that long.
  StyledRow& PadTo(int columns);

  int width() const { return width_; }
  bool empty() const { return parts_.empty(); }

  /// The row cut to so many columns, without blanks at its end, with the sequences that a terminal
  /// needs for its looks.
  std::string Text(int columns, const ScreenStyle& style) const;

 private:
  struct Part {
    std::string text;
    Look look;
  };
  std::vector<Part> parts_;
  int width_ = 0;
};

using Rows = std::vector<StyledRow>;

/// Items one after the other in as many rows as they need. An item that is wider than a row has one
/// of its own.
/// @param indent  blanks before the second row and those after it
/// @param gap     blanks between two items of a row
Rows Flow(const Rows& items, int columns, int indent = 2, int gap = 2);

/// A text in as many rows as it needs.
Rows WrapWords(std::string_view text, int columns);

}  // namespace flexarm
