#include "tools/report/html_page.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace flexarm {
namespace {

constexpr const char* kStyle =
    "body{font:16px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;"
    "color:#1a1a1a;background:#fff}"
    "h1{font-size:1.8rem}h2{margin-top:3rem;border-bottom:1px solid #ccc}"
    "table{border-collapse:collapse;margin:1rem 0;font-size:.9rem}"
    "th,td{border:1px solid #ddd;padding:.3rem .6rem;text-align:left;vertical-align:top}"
    "th{background:#f4f4f4}figure{margin:1.5rem 0}img{max-width:100%;border:1px solid #eee}"
    "figcaption{font-size:.9rem;color:#444}nav a{display:block}"
    ".v{white-space:nowrap;font-weight:600}.holds{color:#00704a}.does-not{color:#b03000}"
    ".part,.depends{color:#8a6000}.not{color:#666}";

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

// RFC 4648.
std::string Base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63U];
    }
  }
  return text;
}

std::string TableRow(const std::vector<std::string>& cells, const char* tag) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) {
    row += std::string("<") + tag + ">" + Escaped(cell) + "</" + tag + ">";
  }
  return row + "</tr>\n";
}

const char* ClassOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHolds:
      return "v holds";
    case Verdict::kInPart:
      return "v part";
    case Verdict::kDepends:
      return "v depends";
    case Verdict::kDoesNot:
      return "v does-not";
    case Verdict::kNotTested:
      return "v not";
  }
  return "v";
}

}  // namespace

HtmlPage::HtmlPage(std::string title) : title_(std::move(title)) {}

void HtmlPage::Section(const std::string& title) {
  std::string id = "section-";
  id += std::to_string(++sections_);
  contents_ += "<a href=\"#" + id + "\">" + Escaped(title) + "</a>\n";
  body_ += "<h2 id=\"" + id + "\">" + Escaped(title) + "</h2>\n";
}

void HtmlPage::Paragraph(const std::string& text) { body_ += "<p>" + Escaped(text) + "</p>\n"; }

void HtmlPage::Table(const std::vector<std::string>& head,
                     const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>\n" + TableRow(head, "th");
  for (const auto& row : rows) body_ += TableRow(row, "td");
  body_ += "</table>\n";
}

void HtmlPage::Picture(const std::filesystem::path& png, const std::string& caption) {
  std::ifstream file(png, std::ios::binary);
  if (!file) throw std::runtime_error(png.string() + ": cannot be read");
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  body_ += "<figure><img alt=\"" + Escaped(caption) + "\" src=\"data:image/png;base64," +
           Base64(bytes) + "\"><figcaption>" + Escaped(caption) + "</figcaption></figure>\n";
}

void HtmlPage::Statements(const std::vector<Statement>& statements) {
  body_ +=
      "<table>\n" + TableRow({"section", "the thesis says", "the model says", "verdict"}, "th");
  for (const Statement& s : statements) {
    body_ += "<tr><td>" + Escaped(s.section) + "</td><td>" + Escaped(s.thesis) + "</td><td>" +
             Escaped(s.model) + "</td><td class=\"" + ClassOf(s.verdict) + "\">" +
             ToString(s.verdict) + "</td></tr>\n";
  }
  body_ += "</table>\n";
}

std::string HtmlPage::Text() const {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
         "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         Escaped(title_) + "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" +
         Escaped(title_) + "</h1>\n<p>" + Escaped(lead_) + "</p>\n<nav>\n" + contents_ +
         "</nav>\n" + body_ + "</body></html>\n";
}

}  // namespace flexarm
