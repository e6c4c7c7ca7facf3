#include "controller/runlog/csv_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "controller/files/external_text.h"
#include "controller/runlog/csv.h"
#include "controller/runlog/csv_sampling.h"
#include "controller/types/rounded_text.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, kCounters> kCounterTargets = {"hub1", "hub2", "rotor1", "rotor2"};
constexpr std::array<const char*, 2> kTorqueTargets = {"torque_1", "torque_2"};

// All targets for which a file for this rig must have a column.
std::vector<std::string> NeededTargets(const SensorConfig& sensors) {
  std::vector<std::string> needed = {"time", kTorqueTargets[0], kTorqueTargets[1]};
  for (std::size_t i = 0; i < kCounterTargets.size(); ++i) {
    if ((sensors.counters_present() >> i & 1U) != 0) needed.emplace_back(kCounterTargets[i]);
  }
  const std::vector<std::string> strain = StrainColumns(sensors);
  needed.insert(needed.end(), strain.begin(), strain.end());
  return needed;
}

// Converts samples in SI units to the readings of the rig's converters.
class ReadingsOf {
 public:
  ReadingsOf(const CsvImport& import, const SensorConfig& sensors, const CsvSamples& samples)
      : import_(import), sensors_(sensors), samples_(samples), strain_(StrainColumns(sensors)) {}

  /// @param table  names the place of an impossible value
  void Read(std::size_t sample, const CsvTable& table, StepInput* input,
            std::array<double, kMaxStrainChannels>* counts, CsvFacts* facts) const {
    ReadCounters(sample, table, input);
    SensorFrame* frame = &input->frame;
    const StrainInputConfig& converter = sensors_.strain_input;
    for (std::size_t i = 0; i < strain_.size(); ++i) {
      const double volts = Value(strain_[i], sample);
      if (std::isnan(volts)) continue;
      (*counts)[i] = volts / converter.volts_per_count();
      const auto lowest = static_cast<double>(converter.lowest_count());
      const auto highest = static_cast<double>(converter.highest_count());
      frame->strain[i] =
          static_cast<std::int32_t>(std::lround(std::clamp((*counts)[i], lowest, highest)));
      frame->strain_valid |= std::uint32_t{1} << i;
      if ((*counts)[i] < lowest - 0.5 || (*counts)[i] > highest + 0.5) ++facts->beyond_range[i];
    }
  }

 private:
  double Value(std::string_view target, std::size_t sample) const {
    return samples_.value[ColumnOf(import_, target)][sample];
  }

  void ReadCounters(std::size_t sample, const CsvTable& table, StepInput* input) const {
    for (const EncoderConfig& encoder : sensors_.encoder) {
      const auto i = static_cast<std::size_t>(encoder.counter);
      const double angle_rad = Value(kCounterTargets[i], sample);
      if (std::isnan(angle_rad)) continue;
      const double counts =
          encoder.sign * angle_rad * encoder.counts_per_turn / (2.0 * std::numbers::pi);
      if (std::abs(counts) > 1e15) {  // above this a double does not represent every integer
        const CsvColumn& column = import_.column[ColumnOf(import_, kCounterTargets[i])];
        table.FailAt(samples_.line[sample],
                     Shown(column.column) + ": found " + RoundedText(angle_rad, 6) +
                         " rad, expected an angle within the range of this encoder");
      }
      const std::int64_t modulus = std::int64_t{1} << encoder.counter_bits;
      if (input->reset != 0)
        input->counts_before[i] = std::llround(counts);  // the file includes whole turns
      const std::int64_t raw = std::llround(counts) % modulus;
      input->frame.counter[i] = static_cast<std::uint32_t>(raw < 0 ? raw + modulus : raw);
      input->frame.counter_valid |= std::uint32_t{1} << i;
    }
  }

  const CsvImport& import_;
  const SensorConfig& sensors_;
  const CsvSamples& samples_;
  std::vector<std::string> strain_;
};

// A decoded file is ours too: ReadCsv says what to do.
bool IsOurs(const CsvTable& table) { return table.Has("valid") || IsDecoded(table); }

std::vector<std::string> ColumnsOf(const CsvImport& import) {
  std::vector<std::string> names;
  for (const CsvColumn& column : import.column) names.push_back(column.column);
  return names;
}

CsvColumnUse UseOf(const CsvTable& table, const CsvImport* import, const SensorConfig& sensors) {
  CsvColumnUse use{
      .own = import == nullptr || IsOurs(table), .used = {}, .unused = {}, .missing = {}};
  const std::vector<std::string> needed = use.own ? OwnColumns(sensors) : ColumnsOf(*import);
  for (const std::string& name : table.columns()) {
    const bool is_used = std::find(needed.begin(), needed.end(), name) != needed.end();
    (is_used ? use.used : use.unused).push_back(name);
  }
  for (const std::string& name : needed) {
    if (!table.Has(name)) use.missing.push_back(name);
  }
  return use;
}

void DescribeTable(const CsvTable& table, const CsvColumnUse& use, CsvFacts* facts) {
  facts->own = use.own;
  facts->separator = table.separator();
  facts->decimal_comma = table.decimal_comma();
  facts->used = use.used;
  facts->unused = use.unused;
}

void DescribeTimes(const std::vector<double>& time_s, CsvFacts* facts) {
  facts->rows = static_cast<std::int64_t>(time_s.size());
  facts->duration_s = time_s.back() - time_s.front();
  facts->row_spacing_s = TypicalSpacing_s(time_s);
}

CsvRun ReadOwnCsv(const std::filesystem::path& file, const SensorConfig& sensors, double period_s) {
  CsvRun run{.input = ReadCsv(file, sensors, period_s), .strain_counts = {}, .facts = {}};
  std::vector<double> time_s;
  for (const StepInput& input : run.input) {
    std::array<double, kMaxStrainChannels> counts{};
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = input.frame.strain[i];
    run.strain_counts.push_back(counts);
    time_s.push_back(static_cast<double>(input.now_ns) * 1e-9);
  }
  const CsvTable table(file);
  DescribeTable(table, UseOf(table, nullptr, sensors), &run.facts);
  DescribeTimes(time_s, &run.facts);
  return run;
}

}  // namespace

std::vector<Problem> ProblemsOf(const CsvImport& import, const SensorConfig& sensors) {
  ProblemList list("csv.");
  list.Within("decimation", import.decimation, 1, 10000, "rows per period of the loop");
  list.Require(import.longest_gap_s >= 0.0 && import.longest_gap_s <= 60.0, "longest_gap_s",
               NumberText(import.longest_gap_s),
               "must lie in 0 .. 60: over more, linear interpolation says nothing");
  const std::vector<std::string> needed = NeededTargets(sensors);
  std::string all;
  for (const std::string& target : needed) all += " " + target;
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < import.column.size(); ++i) {
    const CsvColumn& c = import.column[i];
    const std::string row = ProblemList::Element("column", i);
    list.Require(!c.column.empty(), row + ".column", "\"\"", "must name a column of the header");
    list.Require(c.scale != 0.0 && std::abs(c.scale) <= 1e12, row + ".scale", NumberText(c.scale),
                 "must not be 0, nor beyond +-1e12");
    list.Require(std::find(needed.begin(), needed.end(), c.target) != needed.end(), row + ".target",
                 "\"" + c.target + "\"", "must be one of what this rig measures:" + all);
    list.Require(std::find(seen.begin(), seen.end(), c.target) == seen.end(), row + ".target",
                 "\"" + c.target + "\"", "must be the target of one column only");
    seen.push_back(c.target);
  }
  for (const std::string& target : needed) {
    list.Require(std::find(seen.begin(), seen.end(), target) != seen.end(), "column",
                 NumberText(import.column.size()) + " rows",
                 "must have a row with target = \"" + target + "\"");
  }
  return list.Take();
}

CsvRun ReadForeignCsv(const std::filesystem::path& file, const CsvImport& import,
                      const SensorConfig& sensors, double period_s) {
  CsvTable table(file, import.separator);
  table.Need(ColumnsOf(import));
  const CsvRows rows = ReadRows(&table, import);
  if (!import.resample) RequireEvenTimes(table, rows, import, period_s);
  const CsvSamples samples =
      import.resample ? Resampled(table, rows, import, period_s) : Decimated(rows, import);
  CsvRun run;
  run.facts.units_row = rows.units_row;
  DescribeTable(table, UseOf(table, &import, sensors), &run.facts);
  DescribeTimes(rows.time_s, &run.facts);
  if (import.resample) {
    run.facts.resampling = {.longest_gap_s = LongestGap_s(import, period_s),
                            .longest_missing_s = samples.longest_gap_s,
                            .rows_left_out = samples.rows_left_out,
                            .samples_not_read = samples.samples_not_read};
  }
  const ReadingsOf readings(import, sensors, samples);
  for (std::size_t k = 0; k < samples.time_s.size(); ++k) {
    StepInput input = CsvInput(samples.time_s[k], period_s, run.input);
    std::array<double, kMaxStrainChannels> counts{};
    readings.Read(k, table, &input, &counts, &run.facts);
    input.applied_torque_nm = samples.torque_nm[k];
    run.input.push_back(input);
    run.strain_counts.push_back(counts);
  }
  return run;
}

CsvColumnUse ColumnsIn(const std::filesystem::path& file, const CsvImport* import,
                       const SensorConfig& sensors) {
  return UseOf(CsvTable(file, import == nullptr ? char{0} : import->separator), import, sensors);
}

CsvRun ReadAnyCsv(const std::filesystem::path& file, const CsvImport* import,
                  const SensorConfig& sensors, double period_s) {
  const char separator = import == nullptr ? char{0} : import->separator;
  if (IsOurs(CsvTable(file, separator))) return ReadOwnCsv(file, sensors, period_s);
  if (import != nullptr) return ReadForeignCsv(file, *import, sensors, period_s);
  CsvTable(file).Fail(
      "found no column valid in the header, expected a file of `flexarm export`, or a config with "
      "a table [csv] that maps the columns of this one");
}

}  // namespace flexarm
