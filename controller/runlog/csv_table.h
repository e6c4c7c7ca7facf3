#pragma once

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace flexarm {

/// A CSV file with a header, read row by row (ReadExternalFile, so at most 256 MiB). Lines that are
/// empty or begin with # % or // are skipped. Not movable: cells are views into the text.
///
/// Cells are separated by commas, semicolons or tabs, whichever stand in the header, or as the
/// first line says (`sep=;`). Cells may be in quotes, in which two quotes are one. Numbers have a
/// point; where commas do not separate cells, all may have a comma instead.
///
/// Every error is an InputError: "file:line: column: found .., expected ..".
class CsvTable {
 public:
  /// Opens the file and reads its header. @param separator  0: found from the header
  explicit CsvTable(const std::filesystem::path& file, char separator = 0);
  CsvTable(const CsvTable&) = delete;
  CsvTable& operator=(const CsvTable&) = delete;
  /// The same for a text in memory; `file` is its name in messages.
  CsvTable(std::string file, std::string text, char separator = 0);

  bool Has(std::string_view column) const { return column_.find(column) != column_.end(); }
  /// The header must have these columns.
  void Need(const std::vector<std::string>& columns) const;
  /// Names in the header, in its order.
  const std::vector<std::string>& columns() const { return name_; }
  char separator() const { return separator_; }
  bool decimal_comma() const { return decimal_ == ','; }  ///< of the numbers that were read
  int line() const { return line_number_; }               ///< of the present row, 1-based

  /// Goes to the next row; false at the end of the file.
  bool Next();

  // Values of the present row, in a column that the header has.
  std::string_view Cell(std::string_view column) const;
  double Number(std::string_view column) const;  ///< finite
  /// The same, or nothing for a cell without a reading: empty, NaN, NA or null.
  std::optional<double> NumberIfAny(std::string_view column) const;
  bool IsNumber(std::string_view column) const;
  /// An integer within the range of T, after `skip` characters of the cell.
  template <typename T>
  T Whole(std::string_view column, const std::string& expected, int base = 10,
          std::size_t skip = 0) const;

  [[noreturn]] void Fail(const std::string& what) const { FailAt(line_number_, what); }
  [[noreturn]] void FailAt(int line, const std::string& what) const;
  [[noreturn]] void FailCell(std::string_view column, const std::string& expected) const;

 private:
  void ReadHeader();
  void FindSeparator(std::string_view header);
  std::vector<std::string_view> Cells(std::string_view line);
  std::string_view QuotedCell(std::string_view* line);
  std::string_view NextLine();
  std::string PlainNumber(std::string_view column) const;

  std::string file_;
  std::string text_;
  std::size_t next_ = 0;  // start of the next line
  int line_number_ = 0;
  char separator_;
  mutable char decimal_ = 0;  // of the numbers so far: '.', ',' or 0
  mutable int decimal_line_ = 0;
  std::vector<std::string_view> cells_;
  std::vector<std::string> name_;
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
