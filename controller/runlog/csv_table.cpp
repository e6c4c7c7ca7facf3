#include "controller/runlog/csv_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/files/external_file.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"

namespace flexarm {
namespace {

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> Cells(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t comma = line.find(',');
    cells.push_back(Trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file)
    : CsvTable(file.string(), ReadExternalText(file, kCsvFile)) {}

CsvTable::CsvTable(std::string file, std::string text)
    : file_(std::move(file)), text_(PlainText(std::move(text))) {
  if (!Next()) Fail("found an empty file, expected a header with the names of the columns");
  if (cells_.size() == 1 && cells_[0].find(';') != std::string_view::npos) {
    Fail("found semicolons between the columns, expected commas and a point in decimals");
  }
  columns_ = cells_.size();
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (!column_.emplace(cells_[i], i).second) {
      Fail("found column " + Shown(cells_[i]) + " twice, expected it once");
    }
  }
}

void CsvTable::Need(std::string_view column) const {
  if (Has(column)) return;
  Fail("found no column " + Shown(column) + " in the header, expected it for this config");
}

bool CsvTable::Next() {
  while (next_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', next_), text_.size());
    const std::string_view text = Trimmed(std::string_view(text_).substr(next_, end - next_));
    next_ = end + 1;
    ++line_number_;
    if (text.empty() || text.front() == '#') continue;
    cells_ = Cells(text);
    if (!column_.empty() && cells_.size() != columns_) {
      Fail("found " + std::to_string(cells_.size()) + " values, expected " +
           std::to_string(columns_) + " as in the header");
    }
    return true;
  }
  return false;
}

std::string_view CsvTable::Cell(std::string_view column) const {
  return cells_[column_.find(column)->second];
}

double CsvTable::Number(std::string_view column) const {
  const std::string_view cell = Cell(column);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    FailCell(column, "a number");
  }
  return value;
}

void CsvTable::Fail(const std::string& what) const {
  throw InputError(Shown(file_, kMessageBytes) + ":" + std::to_string(line_number_) + ": " + what);
}

void CsvTable::FailCell(std::string_view column, const std::string& expected) const {
  Fail(Shown(column) + ": found \"" + Shown(Cell(column)) + "\", expected " + expected);
}

}  // namespace flexarm
