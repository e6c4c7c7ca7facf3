#include "controller/runlog/csv_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "controller/runlog/csv.h"
#include "controller/runlog/csv_table.h"
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

// Reads the rows of one file, in SI units.
class ForeignReader {
 public:
  ForeignReader(const std::filesystem::path& file, const CsvImport& import,
                const SensorConfig& sensors, double period_s)
      : table_(file),
        import_(import),
        sensors_(sensors),
        strain_(StrainColumns(sensors)),
        period_s_(period_s) {
    for (const CsvColumn& column : import.column) table_.Need(column.column);
  }

  std::vector<StepInput> Read() {
    std::vector<StepInput> inputs;
    for (std::int64_t row = 0; table_.Next(); ++row) {
      CheckTime(row);
      const std::array<double, 2> torque = {Value(kTorqueTargets[0]), Value(kTorqueTargets[1])};
      if (row == 0) torque_before_ = torque_sum_ = torque;
      if (row > 0) Accumulate(torque);
      if (row % import_.decimation != 0) continue;
      StepInput input = CsvInput(Value("time"), period_s_, inputs);
      ReadFrame(&input);
      const double rows = row == 0 ? 1.0 : import_.decimation;
      input.applied_torque_nm = {torque_sum_[0] / rows, torque_sum_[1] / rows};
      torque_sum_ = {};
      inputs.push_back(input);
    }
    if (inputs.empty()) table_.Fail("found no rows, expected at least one sample");
    return inputs;
  }

 private:
  const CsvColumn& ColumnOf(std::string_view target) const {
    return *std::find_if(import_.column.begin(), import_.column.end(),
                         [&](const CsvColumn& column) { return column.target == target; });
  }

  double Value(std::string_view target) const {
    const CsvColumn& column = ColumnOf(target);
    return column.scale * column.unit * table_.Number(column.column) + column.offset;
  }

  void CheckTime(std::int64_t row) {
    const double time_s = Value("time");
    const std::string& name = ColumnOf("time").column;
    if (std::abs(time_s) > kLongestCsv_s) table_.FailCell(name, "at most 1e8 s");
    if (row == 0) start_s_ = time_s;
    const double spacing_s = period_s_ / import_.decimation;
    const double expected_s = start_s_ + static_cast<double>(row) * spacing_s;
    if (std::abs(time_s - expected_s) <= 0.1 * spacing_s) return;
    table_.FailCell(name, NumberText(expected_s) + " s: the rows are " + NumberText(spacing_s) +
                              " s apart, loop.period_ms / csv.decimation");
  }

  void Accumulate(const std::array<double, 2>& torque) {
    for (std::size_t i = 0; i < 2; ++i) {
      torque_sum_[i] += 0.5 * (torque_before_[i] + torque[i]);
      torque_before_[i] = torque[i];
    }
  }

  void ReadFrame(StepInput* input) const {
    SensorFrame* frame = &input->frame;
    for (const EncoderConfig& encoder : sensors_.encoder) {
      const auto i = static_cast<std::size_t>(encoder.counter);
      const double counts = encoder.sign * Value(kCounterTargets[i]) * encoder.counts_per_turn /
                            (2.0 * std::numbers::pi);
      if (std::abs(counts) > 1e15) {  // above this a double does not represent every integer
        table_.FailCell(ColumnOf(kCounterTargets[i]).column,
                        "an angle within the range of this encoder");
      }
      const std::int64_t modulus = std::int64_t{1} << encoder.counter_bits;
      if (input->reset != 0)
        input->counts_before[i] = std::llround(counts);  // the file includes whole turns
      const std::int64_t raw = std::llround(counts) % modulus;
      frame->counter[i] = static_cast<std::uint32_t>(raw < 0 ? raw + modulus : raw);
      frame->counter_valid |= std::uint32_t{1} << i;
    }
    for (std::size_t i = 0; i < strain_.size(); ++i) {
      const double counts = Value(strain_[i]) / sensors_.strain_input.volts_per_count();
      frame->strain[i] = static_cast<std::int32_t>(
          std::lround(std::clamp(counts, static_cast<double>(sensors_.strain_input.lowest_count()),
                                 static_cast<double>(sensors_.strain_input.highest_count()))));
      frame->strain_valid |= std::uint32_t{1} << i;
    }
  }

  CsvTable table_;
  const CsvImport& import_;
  const SensorConfig& sensors_;
  std::vector<std::string> strain_;
  double period_s_;
  double start_s_ = 0.0;
  std::array<double, 2> torque_before_{}, torque_sum_{};
};

// A decoded file is ours too: ReadCsv says what to do.
bool IsOurs(const CsvTable& table) { return table.Has("valid") || IsDecoded(table); }

}  // namespace

std::vector<Problem> ProblemsOf(const CsvImport& import, const SensorConfig& sensors) {
  ProblemList list("csv.");
  list.Within("decimation", import.decimation, 1, 10000, "rows per period of the loop");
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

std::vector<StepInput> ReadForeignCsv(const std::filesystem::path& file, const CsvImport& import,
                                      const SensorConfig& sensors, double period_s) {
  return ForeignReader(file, import, sensors, period_s).Read();
}

std::vector<StepInput> ReadAnyCsv(const std::filesystem::path& file, const CsvImport* import,
                                  const SensorConfig& sensors, double period_s) {
  return import == nullptr || IsOurs(CsvTable(file))
             ? ReadCsv(file, sensors, period_s)
             : ReadForeignCsv(file, *import, sensors, period_s);
}

}  // namespace flexarm
