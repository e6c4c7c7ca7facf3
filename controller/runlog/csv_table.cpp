#include "controller/runlog/csv_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controller/files/external_file.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"

namespace flexarm {
namespace {

struct Separator {
  char character;
  const char* name;
};
constexpr std::array<Separator, 3> kSeparators = {
    {{',', "commas"}, {';', "semicolons"}, {'\t', "tabs"}}};

std::string_view Trimmed(std::string_view text, const char* spaces = " \t\r") {
  const std::size_t first = text.find_first_not_of(spaces);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(spaces) - first + 1);
}

bool IsComment(std::string_view line) {
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

bool StandsOutsideQuotes(std::string_view line, char character) {
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == character && !quoted) return true;
  }
  return false;
}

bool IsMissing(std::string_view cell) {
  std::string lower(cell);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower.empty() || lower == "nan" || lower == "na" || lower == "null";
}

// The whole text as a finite number.
std::optional<double> Parsed(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file, char separator)
    : CsvTable(file.string(), ReadExternalText(file, kCsvFile), separator) {}

CsvTable::CsvTable(std::string file, std::string text, char separator)
    : file_(std::move(file)), text_(PlainText(std::move(text))), separator_(separator) {
  ReadHeader();
}

void CsvTable::ReadHeader() {
  std::string_view header = NextLine();
  if (header.data() == nullptr) {
    Fail("found an empty file, expected a header with the names of the columns");
  }
  if (header.starts_with("sep=") && header.size() == 5) {  // as Excel reads and writes it
    if (separator_ == 0) separator_ = header[4];
    header = NextLine();
  }
  FindSeparator(header);
  for (const std::string_view cell : Cells(header)) {
    name_.emplace_back(cell);
    if (!cell.empty() && !column_.emplace(cell, name_.size() - 1).second) {
      Fail("found column " + Shown(cell) + " twice, expected it once");
    }
  }
}

void CsvTable::FindSeparator(std::string_view header) {
  std::vector<const Separator*> found;
  for (const Separator& separator : kSeparators) {
    if (StandsOutsideQuotes(header, separator.character)) found.push_back(&separator);
  }
  if (separator_ != 0) {
    const bool stands = StandsOutsideQuotes(header, separator_);
    if (stands || found.empty()) return;
    Fail(std::string("found ") + found[0]->name +
         " between the columns, expected the separator \"" + Shown(std::string(1, separator_)) +
         "\" that was stated");
  }
  if (found.size() > 1) {
    Fail(std::string("found ") + found[0]->name + " and " + found[1]->name +
         " in the header, expected one of them: put names that contain the other in quotes, or, "
         "in the config of a rig, set csv.separator");
  }
  if (found.empty() && header.find(' ') != std::string_view::npos &&
      header.find('"') == std::string_view::npos) {
    Fail("found spaces in the header, expected commas, semicolons or tabs between the columns");
  }
  separator_ = found.empty() ? ',' : found[0]->character;
}

void CsvTable::Need(const std::vector<std::string>& columns) const {
  std::string missing, others;
  for (const std::string& column : columns) {
    if (Has(column)) continue;
    if (missing.empty()) {
      missing = Shown(column);
    } else {
      others += (others.empty() ? "; also missing: " : ", ") + Shown(column);
    }
  }
  if (missing.empty()) return;
  Fail("found no column " + missing + " in the header, expected it for this config" + others);
}

// The next line that is neither empty nor a comment; at the end of the file, none (null).
std::string_view CsvTable::NextLine() {
  while (next_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', next_), text_.size());
    const std::string_view line = std::string_view(text_).substr(next_, end - next_);
    next_ = end + 1;
    ++line_number_;
    const std::string_view text = Trimmed(line);
    if (!text.empty() && !IsComment(text)) return line;
  }
  return {};
}

// Takes a cell in quotes from the front of the line, which begins with one.
std::string_view CsvTable::QuotedCell(std::string_view* line) {
  // Two quotes become one in place: the result is no longer than what it stands for.
  char* const begin = text_.data() + (line->data() - text_.data()) + 1;
  char* out = begin;
  for (std::size_t i = 1; i < line->size(); ++i) {
    if ((*line)[i] == '"') {
      if (i + 1 == line->size() || (*line)[i + 1] != '"') {
        line->remove_prefix(i + 1);
        return {begin, static_cast<std::size_t>(out - begin)};
      }
      ++i;
    }
    *out++ = (*line)[i];
  }
  Fail("found a quote without a second one on the line, expected each cell on one line");
}

std::vector<std::string_view> CsvTable::Cells(std::string_view line) {
  const char* const spaces = separator_ == '\t' ? " \r" : " \t\r";
  std::vector<std::string_view> cells;
  while (true) {
    const std::string_view rest = Trimmed(line, spaces);
    if (rest.starts_with('"')) {
      line = rest;
      const std::string_view cell = QuotedCell(&line);
      cells.push_back(Trimmed(cell));
      const std::size_t end = std::min(line.find(separator_), line.size());
      if (!Trimmed(line.substr(0, end), spaces).empty()) {
        Fail("found \"" + Shown(Trimmed(line.substr(0, end))) +
             "\" behind a quoted cell, expected " + "the next separator");
      }
      if (end == line.size()) return cells;
      line.remove_prefix(end + 1);
      continue;
    }
    const std::size_t end = line.find(separator_);
    cells.push_back(Trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

bool CsvTable::Next() {
  const std::string_view line = NextLine();
  if (line.data() == nullptr) return false;
  cells_ = Cells(line);
  if (cells_.size() == name_.size()) return true;
  Fail("found " + std::to_string(cells_.size()) + " values, expected " +
       std::to_string(name_.size()) + " as in the header");
}

std::string_view CsvTable::Cell(std::string_view column) const {
  return cells_[column_.find(column)->second];
}

bool CsvTable::IsNumber(std::string_view column) const {
  std::string text(Cell(column));
  if (separator_ != ',') std::replace(text.begin(), text.end(), ',', '.');
  return Parsed(text).has_value();
}

// The cell with a decimal point.
std::string CsvTable::PlainNumber(std::string_view column) const {
  std::string text(Cell(column));
  const std::size_t comma = separator_ == ',' ? std::string::npos : text.find(',');
  const bool has_comma = comma != std::string::npos;
  const bool has_point = text.find('.') != std::string::npos;
  if (!has_comma && !has_point) return text;
  if (has_comma && (has_point || text.find(',', comma + 1) != std::string::npos)) {
    FailCell(column, "a number without separators between thousands");
  }
  const char decimal = has_comma ? ',' : '.';
  if (decimal_ == 0) {
    decimal_ = decimal;
    decimal_line_ = line_number_;
  }
  if (decimal_ != decimal) {
    FailCell(column, std::string("a decimal ") + (decimal_ == ',' ? "comma" : "point") +
                         ", as in line " + std::to_string(decimal_line_));
  }
  if (has_comma) text[comma] = '.';
  return text;
}

double CsvTable::Number(std::string_view column) const {
  const std::optional<double> value = Parsed(PlainNumber(column));
  if (!value) FailCell(column, "a number");
  return *value;
}

std::optional<double> CsvTable::NumberIfAny(std::string_view column) const {
  if (IsMissing(Cell(column))) return std::nullopt;
  return Number(column);
}

void CsvTable::FailAt(int line, const std::string& what) const {
  throw InputError(Shown(file_, kMessageBytes) + ":" + std::to_string(line) + ": " + what);
}

void CsvTable::FailCell(std::string_view column, const std::string& expected) const {
  Fail(Shown(column) + ": found \"" + Shown(Cell(column)) + "\", expected " + expected);
}

}  // namespace flexarm
