#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/analysis/statement.h"

namespace flexarm {

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
  /// Adds a table: statement of the thesis, result of the model, verdict.
  void Statements(const std::vector<Statement>& statements);

  /// The whole page.
  std::string Text() const;

 private:
  std::string title_, lead_;
  std::string first_, contents_, body_;
  int sections_ = 0;
};

}  // namespace flexarm
