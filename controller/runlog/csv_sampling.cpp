#include "controller/runlog/csv_sampling.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "controller/files/external_text.h"
#include "controller/types/rounded_text.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, 2> kTorques = {"torque_1", "torque_2"};
constexpr double kUnread = std::numeric_limits<double>::quiet_NaN();
constexpr double kAnyGap_s = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1.0 + 1e-9;  // of times in decimals
constexpr double kMostMissing_s = 600.0;  // more is another recording

struct Reading {
  double time_s, value;
};

// Piecewise linear through the readings of a column. Calls must not go back in time.
class Interpolation {
 public:
  explicit Interpolation(std::vector<Reading> reading) : reading_(std::move(reading)) {}

  double first_s() const { return reading_.front().time_s; }
  double longest_gap_s() const {
    double longest_s = 0.0;
    for (std::size_t i = 1; i < reading_.size(); ++i) {
      longest_s = std::max(longest_s, reading_[i].time_s - reading_[i - 1].time_s);
    }
    return longest_s;
  }

  // NaN after the last reading, and between readings farther apart than longest_s; where that is
  // infinite, the last reading.
  double At(double time_s, double longest_s) {
    while (next_ < reading_.size() && reading_[next_].time_s < time_s) ++next_;
    if (next_ == reading_.size()) return std::isinf(longest_s) ? reading_.back().value : kUnread;
    const Reading& after = reading_[next_];
    if (after.time_s == time_s || next_ == 0) return after.value;
    const Reading& before = reading_[next_ - 1];
    const double width_s = after.time_s - before.time_s;
    if (width_s > longest_s * kRounding) return kUnread;
    return before.value + (after.value - before.value) * (time_s - before.time_s) / width_s;
  }

  // Its integral from the first reading on; constant before and after.
  double IntegralUntil(double time_s) {
    while (passed_ + 1 < reading_.size() && reading_[passed_ + 1].time_s <= time_s) {
      const Reading &a = reading_[passed_], &b = reading_[passed_ + 1];
      sum_ += 0.5 * (a.value + b.value) * (b.time_s - a.time_s);
      ++passed_;
    }
    const Reading& a = reading_[passed_];
    const double part_s = time_s - a.time_s;
    if (passed_ + 1 == reading_.size() || part_s <= 0.0) return sum_ + a.value * part_s;
    const Reading& b = reading_[passed_ + 1];
    const double slope = (b.value - a.value) / (b.time_s - a.time_s);
    return sum_ + part_s * (a.value + 0.5 * slope * part_s);
  }

 private:
  std::vector<Reading> reading_;
  std::size_t next_ = 0, passed_ = 0;
  double sum_ = 0.0;
};

// Rows in the order of time.
std::vector<std::size_t> AdvancingRows(const std::vector<double>& time_s) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    if (rows.empty() || time_s[i] > time_s[rows.back()]) rows.push_back(i);
  }
  return rows;
}

std::vector<Interpolation> InterpolationsOf(const CsvTable& table, const CsvRows& rows,
                                            const CsvImport& import,
                                            const std::vector<std::size_t>& advancing) {
  std::vector<Interpolation> lines;
  for (std::size_t i = 0; i < rows.value.size(); ++i) {
    std::vector<Reading> readings;
    for (const std::size_t row : advancing) {
      if (!std::isnan(rows.value[i][row]))
        readings.push_back({rows.time_s[row], rows.value[i][row]});
    }
    if (readings.empty()) {
      table.FailAt(rows.line.back(),
                   Shown(import.column[i].column) + ": found no reading in any row, expected some");
    }
    lines.emplace_back(std::move(readings));
  }
  return lines;
}

void RequireReadings(const CsvTable& table, const CsvRows& rows,
                     const std::vector<std::size_t>& advancing, double longest_s) {
  std::vector<double> time_s;
  for (const std::size_t row : advancing) time_s.push_back(rows.time_s[row]);
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (time_s[i] - time_s[i - 1] <= kMostMissing_s) continue;
    table.FailAt(rows.line[advancing[i]],
                 "found no rows for " + RoundedText(time_s[i] - time_s[i - 1], 6) +
                     " s before this one, expected at most 600 s: cut the file here");
  }
  const double typical_s = TypicalSpacing_s(time_s);
  if (typical_s <= longest_s * kRounding) return;
  table.FailAt(rows.line.front(),
               "found rows " + RoundedText(typical_s, 6) +
                   " s apart, expected at most csv.longest_gap_s = " + RoundedText(longest_s, 6) +
                   " s, beyond which nothing is read");
}

}  // namespace

double LongestGap_s(const CsvImport& import, double period_s) {
  return import.longest_gap_s > 0.0 ? import.longest_gap_s : 2.0 * period_s;
}

CsvSamples Decimated(const CsvRows& rows, const CsvImport& import) {
  const std::array<std::size_t, 2> column = {ColumnOf(import, kTorques[0]),
                                             ColumnOf(import, kTorques[1])};
  CsvSamples samples;
  samples.value.resize(rows.value.size());
  std::array<double, 2> sum{};
  for (std::size_t row = 0; row < rows.line.size(); ++row) {
    for (std::size_t j = 0; j < 2; ++j) {
      const std::vector<double>& torque = rows.value[column[j]];
      sum[j] += row == 0 ? torque[0] : 0.5 * (torque[row - 1] + torque[row]);
    }
    if (row % static_cast<std::size_t>(import.decimation) != 0) continue;
    const double count = row == 0 ? 1.0 : import.decimation;
    samples.torque_nm.push_back({sum[0] / count, sum[1] / count});
    sum = {};
    samples.time_s.push_back(rows.time_s[row]);
    samples.line.push_back(rows.line[row]);
    for (std::size_t i = 0; i < rows.value.size(); ++i) {
      samples.value[i].push_back(rows.value[i][row]);
    }
  }
  return samples;
}

CsvSamples Resampled(const CsvTable& table, const CsvRows& rows, const CsvImport& import,
                     double period_s) {
  const double longest_s = LongestGap_s(import, period_s);
  const std::vector<std::size_t> advancing = AdvancingRows(rows.time_s);
  RequireReadings(table, rows, advancing, longest_s);
  std::vector<Interpolation> lines = InterpolationsOf(table, rows, import, advancing);
  const std::array<std::size_t, 2> torque = {ColumnOf(import, kTorques[0]),
                                             ColumnOf(import, kTorques[1])};
  CsvSamples samples;
  samples.rows_left_out = static_cast<std::int64_t>(rows.line.size() - advancing.size());
  samples.value.resize(lines.size());
  double start_s = lines[0].first_s();
  for (const Interpolation& line : lines) {
    start_s = std::max(start_s, line.first_s());
    samples.longest_gap_s = std::max(samples.longest_gap_s, line.longest_gap_s());
  }
  const double end_s = rows.time_s[advancing.back()];
  const auto count = std::llround(std::floor((end_s - start_s) / period_s + 1e-9)) + 1;
  std::array<double, 2> until{};
  std::size_t passed = 0;  // of the rows
  for (std::int64_t k = 0; k < count; ++k) {
    const double time_s = std::min(start_s + static_cast<double>(k) * period_s, end_s);
    samples.time_s.push_back(start_s + static_cast<double>(k) * period_s);
    while (passed + 1 < advancing.size() && rows.time_s[advancing[passed + 1]] <= time_s) ++passed;
    samples.line.push_back(rows.line[advancing[passed]]);
    bool all_read = true;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const bool is_torque = i == torque[0] || i == torque[1];
      const double value = lines[i].At(time_s, is_torque ? kAnyGap_s : longest_s);
      samples.value[i].push_back(value);
      all_read = all_read && (is_torque || !std::isnan(value));
    }
    samples.samples_not_read += all_read ? 0 : 1;
    std::array<double, 2> mean_nm{};
    for (std::size_t j = 0; j < 2; ++j) {
      const double integral = lines[torque[j]].IntegralUntil(time_s);
      mean_nm[j] =
          k == 0 ? lines[torque[j]].At(time_s, kAnyGap_s) : (integral - until[j]) / period_s;
      until[j] = integral;
    }
    samples.torque_nm.push_back(mean_nm);
  }
  return samples;
}

}  // namespace flexarm
