#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flexarm {

/// A text as it may stand in HTML, also in an attribute.
std::string EscapedHtml(const std::string& text);

/// One HTML page that needs no other file and no network: style and pictures are embedded. Every
/// text is escaped.
class HtmlPage {
 public:
  explicit HtmlPage(std::string title);

  /// A paragraph that begins the page.
  void Lead(const std::string& text) { lead_ = text; }
  /// All of another page's body, before the table of contents.
  void PutFirst(const HtmlPage& part) { first_ = part.body_; }
  /// A heading without a line in the table of contents.
  void Heading(const std::string& title);
  /// A heading, with a line in the table of contents.
  void Section(const std::string& title);
  void Paragraph(const std::string& text);
  /// Adds a table, which scrolls sideways in its own box where it is wider than the screen.
  void Table(const std::vector<std::string>& head,
             const std::vector<std::vector<std::string>>& rows);
  /// Embeds a .png file, which may be deleted afterwards. A click shows it in full size.
  /// @throws std::runtime_error if it cannot be read
  void Picture(const std::filesystem::path& png, const std::string& caption);
  /// Embeds a picture that is text: an svg element with its title and description.
  void Svg(const std::string& svg, const std::string& caption);
  /// Adds what is HTML already.
  void Markup(const std::string& html) { body_ += html; }

  /// The whole page.
  std::string Text() const;

 private:
  std::string title_, lead_;
  std::string first_, contents_, body_;
  int sections_ = 0;
};

}  // namespace flexarm
