#include "controller/runlog/csv_table.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include "controller/runlog/errors.h"

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
    : CsvTable(file.string(), std::make_unique<std::ifstream>(file, std::ios::binary)) {}

CsvTable::CsvTable(std::string file, const std::string& text)
    : CsvTable(std::move(file), std::make_unique<std::istringstream>(text)) {}

CsvTable::CsvTable(std::string file, std::unique_ptr<std::istream> stream)
    : file_(std::move(file)), stream_(std::move(stream)) {
  if (!*stream_) throw InputError(file_ + ": cannot be opened; expected a CSV file");
  if (!Next()) Fail("found an empty file, expected a header with the names of the columns");
  columns_ = cells_.size();
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (!column_.emplace(cells_[i], i).second) {
      Fail("found column " + std::string(cells_[i]) + " twice, expected it once");
    }
  }
}

void CsvTable::Need(std::string_view column) const {
  if (Has(column)) return;
  Fail("found no column " + std::string(column) + " in the header, expected it for this config");
}

bool CsvTable::Next() {
  while (std::getline(*stream_, line_)) {
    ++line_number_;
    const std::string_view text = Trimmed(line_);
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
  throw InputError(file_ + ":" + std::to_string(line_number_) + ": " + what);
}

void CsvTable::FailCell(std::string_view column, const std::string& expected) const {
  Fail(std::string(column) + ": found \"" + std::string(Cell(column)) + "\", expected " + expected);
}

}  // namespace flexarm
