#pragma once

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace flexarm {

/// A CSV file with a header, read row by row (ReadExternalFile, so at most 256 MiB). Lines that are
/// empty or begin with # are skipped. Not movable: cells are views into the text.
///
/// Every error is an InputError: "file:line: column: found .., expected ..".
class CsvTable {
 public:
  /// Opens the file and reads its header.
  explicit CsvTable(const std::filesystem::path& file);
  CsvTable(const CsvTable&) = delete;
  CsvTable& operator=(const CsvTable&) = delete;
  /// The same for a text in memory; `file` is its name in messages.
  CsvTable(std::string file, std::string text);

  bool Has(std::string_view column) const { return column_.find(column) != column_.end(); }
  /// The header must have `column`.
  void Need(std::string_view column) const;

  /// Goes to the next row; false at the end of the file.
  bool Next();

  // Values of the present row, in a column that the header has.
  std::string_view Cell(std::string_view column) const;
  double Number(std::string_view column) const;  ///< finite
  /// An integer within the range of T, after `skip` characters of the cell.
  template <typename T>
  T Whole(std::string_view column, const std::string& expected, int base = 10,
          std::size_t skip = 0) const;

  [[noreturn]] void Fail(const std::string& what) const;
  [[noreturn]] void FailCell(std::string_view column, const std::string& expected) const;

 private:
  std::string file_;
  std::string text_;
  std::size_t next_ = 0;  // start of the next line
  int line_number_ = 0;
  std::vector<std::string_view> cells_;
  std::size_t columns_ = 0;
  std::map<std::string, std::size_t, std::less<>> column_;
};

template <typename T>
T CsvTable::Whole(std::string_view column, const std::string& expected, int base,
                  std::size_t skip) const {
  const std::string_view cell = Cell(column).substr(skip);
  T value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value, base);
  if (error != std::errc() || end != cell.data() + cell.size()) FailCell(column, expected);
  return value;
}

}  // namespace flexarm
