#include "controller/runlog/csv_rows.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "controller/files/external_text.h"
#include "controller/runlog/csv.h"
#include "controller/types/rounded_text.h"

namespace flexarm {
namespace {

constexpr const char* kAdvice =
    "; `csv.resample = true` interpolates the rows on the loop's samples";

double Unread() { return std::numeric_limits<double>::quiet_NaN(); }

// "[deg]" and "(deg)" as "deg".
std::string_view PlainUnit(std::string_view text) {
  const bool bracketed = text.size() > 2 && ((text.front() == '[' && text.back() == ']') ||
                                             (text.front() == '(' && text.back() == ')'));
  return bracketed ? text.substr(1, text.size() - 2) : text;
}

// No mapped cell is a number, and the one of the time is a text.
bool IsUnitsRow(const CsvTable& table, const CsvImport& import) {
  const std::string& time = import.column[ColumnOf(import, "time")].column;
  const std::string_view unit = PlainUnit(table.Cell(time));
  const bool begins_as_unit =
      !unit.empty() && (std::isalpha(static_cast<unsigned char>(unit[0])) != 0 || unit[0] == '-');
  return begins_as_unit &&
         std::none_of(import.column.begin(), import.column.end(),
                      [&](const CsvColumn& column) { return table.IsNumber(column.column); });
}

void RequireUnits(const CsvTable& table, const CsvImport& import) {
  for (const CsvColumn& column : import.column) {
    const std::string_view text = PlainUnit(table.Cell(column.column));
    const bool known = std::any_of(kCsvUnits.begin(), kCsvUnits.end(),
                                   [&](const CsvUnit& unit) { return unit.name == text; });
    if (!known || column.unit.name == "1" || text == column.unit.name) continue;
    table.FailCell(column.column, "the unit \"" + std::string(column.unit.name) +
                                      "\" that csv.column has for it: change it there");
  }
}

std::string Hz(double spacing_s) { return RoundedText(1.0 / spacing_s, 6) + " Hz"; }

// What the rows of the whole file would need, if another decimation would do.
std::string OtherDecimation(double typical_s, double period_s) {
  const double rows = period_s / typical_s;
  const double whole = std::round(rows);
  if (whole < 1.0 || std::abs(rows - whole) > 1e-3 * whole) return "";
  return ": set csv.decimation = " + RoundedText(whole, 6) +
         ", if that is the rate it was recorded at";
}

}  // namespace

std::size_t ColumnOf(const CsvImport& import, std::string_view target) {
  const auto column =
      std::find_if(import.column.begin(), import.column.end(),
                   [&](const CsvColumn& candidate) { return candidate.target == target; });
  return static_cast<std::size_t>(column - import.column.begin());
}

CsvRows ReadRows(CsvTable* table, const CsvImport& import) {
  CsvRows rows;
  rows.value.resize(import.column.size());
  const std::size_t time = ColumnOf(import, "time");
  while (table->Next()) {
    if (rows.line.empty() && !rows.units_row && IsUnitsRow(*table, import)) {
      rows.units_row = true;
      RequireUnits(*table, import);
      continue;
    }
    for (std::size_t i = 0; i < import.column.size(); ++i) {
      const CsvColumn& column = import.column[i];
      const auto cell =
          i == time ? table->Number(column.column) : table->NumberIfAny(column.column);
      if (!cell && !import.resample) {
        table->FailCell(column.column,
                        std::string("a number") + kAdvice + " and counts this one as not read");
      }
      rows.value[i].push_back(cell ? column.scale * column.unit.si * *cell + column.offset
                                   : Unread());
    }
    rows.line.push_back(table->line());
    rows.time_s.push_back(rows.value[time].back());
    if (std::abs(rows.time_s.back()) > kLongestCsv_s) {
      table->FailCell(import.column[time].column, "at most 1e8 s");
    }
  }
  if (rows.line.empty()) table->Fail("found no rows, expected at least one sample");
  return rows;
}

double TypicalSpacing_s(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return 0.0;
  std::vector<double> spacing;
  spacing.reserve(time_s.size() - 1);
  for (std::size_t i = 1; i < time_s.size(); ++i) spacing.push_back(time_s[i] - time_s[i - 1]);
  const auto middle = spacing.begin() + static_cast<std::ptrdiff_t>(spacing.size() / 2);
  std::nth_element(spacing.begin(), middle, spacing.end());
  return *middle;
}

void RequireEvenTimes(const CsvTable& table, const CsvRows& rows, const CsvImport& import,
                      double period_s) {
  const std::string& name = import.column[ColumnOf(import, "time")].column;
  const double spacing_s = period_s / import.decimation;
  const double typical_s = TypicalSpacing_s(rows.time_s);
  for (std::size_t i = 1; i < rows.time_s.size(); ++i) {
    const double time_s = rows.time_s[i], before_s = rows.time_s[i - 1];
    const double expected_s = rows.time_s[0] + static_cast<double>(i) * spacing_s;
    if (time_s > before_s && std::abs(time_s - expected_s) <= 0.1 * spacing_s) continue;
    const std::string found = Shown(name) + ": found " + RoundedText(time_s, 10) + " s, expected ";
    if (!(time_s > before_s)) {
      table.FailAt(rows.line[i], found + "a time after that of the row before, " +
                                     RoundedText(before_s, 10) +
                                     " s; `csv.resample = true` leaves such rows out");
    }
    const std::string asked =
        RoundedText(spacing_s, 6) + " s, " + Hz(spacing_s) + ", by loop.period_ms / csv.decimation";
    if (typical_s > 0.0 && std::abs(typical_s - spacing_s) > 0.02 * spacing_s) {
      table.FailAt(rows.line[i], found + RoundedText(expected_s, 10) + " s: the rows are " +
                                     RoundedText(typical_s, 6) + " s apart, " + Hz(typical_s) +
                                     ", and should be " + asked +
                                     OtherDecimation(typical_s, period_s) + kAdvice);
    }
    const bool gap = time_s - before_s > 1.5 * spacing_s;
    table.FailAt(rows.line[i],
                 found + RoundedText(expected_s, 10) +
                     " s: " + (gap ? "rows are missing before this one" : "the times are uneven") +
                     "; they should be " + asked + kAdvice);
  }
}

}  // namespace flexarm
