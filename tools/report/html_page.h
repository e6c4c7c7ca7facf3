#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/analysis/statement.h"

namespace flexarm {

/// One HTML page that needs nothing else: style and pictures are inside, no network.
/// Every text is escaped.
class HtmlPage {
 public:
  explicit HtmlPage(std::string title);

  /// A paragraph before the table of contents.
  void Lead(const std::string& text) { lead_ = text; }
  /// A heading, with a line in the table of contents.
  void Section(const std::string& title);
  void Paragraph(const std::string& text);
  /// The first column is left-aligned, the others too if they are words.
  void Table(const std::vector<std::string>& head,
             const std::vector<std::vector<std::string>>& rows);
  /// A .png file, which may be gone afterwards.
  /// @throws std::runtime_error if it cannot be read
  void Picture(const std::filesystem::path& png, const std::string& caption);
  /// What the thesis says, what the model says, and the verdict.
  void Statements(const std::vector<Statement>& statements);

  /// The whole page.
  std::string Text() const;

 private:
  std::string title_, lead_;
  std::string contents_, body_;
  int sections_ = 0;
};

}  // namespace flexarm
