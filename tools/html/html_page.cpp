#include "tools/html/html_page.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

namespace flexarm {
namespace {

constexpr const char* kStyle =
    ":root{--ink:#1a1a1a;--paper:#fff;--line:#ddd;--head:#f4f4f4;--muted:#444;--good:#00704a;"
    "--bad:#b03000;--part:#8a6000}"
    "@media(prefers-color-scheme:dark){:root{--ink:#ececec;--paper:#16181b;--line:#3a3d42;"
    "--head:#24272c;--muted:#b0b0b0;--good:#4fd1a5;--bad:#ff8a5c;--part:#e0b050}}"
    "body{font:16px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;"
    "color:var(--ink);background:var(--paper)}a{color:inherit}"
    "h1{font-size:1.8rem}h2{margin-top:3rem;border-bottom:1px solid var(--line)}"
    ".box{overflow-x:auto;margin:1rem 0}table{border-collapse:collapse;font-size:.9rem}"
    "th,td{border:1px solid var(--line);padding:.3rem .6rem;text-align:left;vertical-align:top}"
    "td{min-width:3rem}td:nth-child(n+2):nth-last-child(n+2){min-width:5rem}"
    "th{background:var(--head)}figure{margin:1.5rem 0}"
    "img{max-width:100%;border:1px solid var(--line);background:#fff;cursor:zoom-in}"
    "svg.chart{width:100%;min-width:40rem;height:auto;box-sizing:border-box;"
    "display:block;border:1px solid var(--line)}"
    "@media print{svg.chart{min-width:0}figure,tr{break-inside:avoid}}"
    "input:checked+img{max-width:none;cursor:zoom-out}"
    "figcaption{font-size:.9rem;color:var(--muted)}nav a{display:block}"
    "@media(min-width:100rem){nav{position:fixed;top:2rem;left:calc(50% + 38rem);"
    "max-width:calc(50vw - 39rem);font-size:.85rem}}"
    ".v{white-space:nowrap;font-weight:600}.holds{color:var(--good)}.does-not{color:var(--bad)}"
    ".part,.depends{color:var(--part)}.not{color:var(--muted)}";

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

std::string TableRow(const std::vector<std::string>& cells, bool is_head) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) {
    row += (is_head ? "<th scope=\"col\">" : "<td>") + EscapedHtml(cell) +
           (is_head ? "</th>" : "</td>");
  }
  return row + "</tr>\n";
}

}  // namespace

std::string EscapedHtml(const std::string& text) {
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

HtmlPage::HtmlPage(std::string title) : title_(std::move(title)) {}

void HtmlPage::Section(const std::string& title) {
  std::string id = "section-";
  id += std::to_string(++sections_);
  contents_ += "<a href=\"#" + id + "\">" + EscapedHtml(title) + "</a>\n";
  body_ += "<h2 id=\"" + id + "\">" + EscapedHtml(title) + "</h2>\n";
}

void HtmlPage::Heading(const std::string& title) {
  body_ += "<h2>" + EscapedHtml(title) + "</h2>\n";
}

void HtmlPage::Paragraph(const std::string& text) { body_ += "<p>" + EscapedHtml(text) + "</p>\n"; }

void HtmlPage::Table(const std::vector<std::string>& head,
                     const std::vector<std::vector<std::string>>& rows) {
  body_ += "<div class=\"box\"><table>\n" + TableRow(head, true);
  for (const auto& row : rows) body_ += TableRow(row, false);
  body_ += "</table></div>\n";
}

void HtmlPage::Picture(const std::filesystem::path& png, const std::string& caption) {
  std::ifstream file(png, std::ios::binary);
  if (!file) throw std::runtime_error(png.string() + ": cannot be read");
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  body_ += "<figure><div class=\"box\"><label><input type=\"checkbox\" hidden><img alt=\"" +
           EscapedHtml(caption) + "\" src=\"data:image/png;base64," + Base64(bytes) +
           "\"></label></div><figcaption>" + EscapedHtml(caption) + "</figcaption></figure>\n";
}

void HtmlPage::Svg(const std::string& svg, const std::string& caption) {
  body_ += "<figure><div class=\"box\">" + svg + "</div><figcaption>" + EscapedHtml(caption) +
           "</figcaption></figure>\n";
}

std::string HtmlPage::Text() const {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
         "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         EscapedHtml(title_) + "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" +
         EscapedHtml(title_) + "</h1>\n<p>" + EscapedHtml(lead_) + "</p>\n" + first_ +
         "<h2>Contents</h2>\n<nav>\n" + contents_ + "</nav>\n" + body_ + "</body></html>\n";
}

}  // namespace flexarm
