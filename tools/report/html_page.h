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

  /// A paragraph before the table of contents.
  void Lead(const std::string& text) { lead_ = text; }
  /// A heading, with a line in the table of contents.
  void Section(const std::string& title);
  void Paragraph(const std::string& text);
  /// Adds a table. The first column is left-aligned, and so are the others if they hold words.
  void Table(const std::vector<std::string>& head,
             const std::vector<std::vector<std::string>>& rows);
  /// Embeds a .png file, which may be deleted afterwards.
  /// @throws std::runtime_error if it cannot be read
  void Picture(const std::filesystem::path& png, const std::string& caption);
  /// Adds a table: statement of the thesis, result of the model, verdict.
  void Statements(const std::vector<Statement>& statements);

  /// The whole page.
  std::string Text() const;

 private:
  std::string title_, lead_;
  std::string contents_, body_;
  int sections_ = 0;
};

}  // namespace flexarm
