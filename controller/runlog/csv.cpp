#include "controller/runlog/csv.h"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

std::uint64_t AllMask(std::uint32_t counters, std::size_t channels) {
  return counters | (((std::uint64_t{1} << channels) - 1) << kCounters);
}

std::string Shortest(double value) {
  std::array<char, 40> text;
  const auto [end, error] = std::to_chars(text.begin(), text.end(), value);
  return error == std::errc() ? std::string(text.begin(), end) : std::string("nan");
}

std::string ValidText(const SensorFrame& frame, std::uint64_t all) {
  const std::uint64_t strain = frame.strain_valid;
  const std::uint64_t mask = (frame.counter_valid | (strain << kCounters)) & all;
  if (mask == all) return "1";
  if (mask == 0) return "0";
  std::array<char, 20> text;
  const auto [end, error] = std::to_chars(text.begin(), text.end(), mask, 16);
  return "0x" + std::string(text.begin(), end);
}

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

// One CSV file being read, line by line.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const SensorConfig& sensors, double period_s)
      : file_(file.string()),
        stream_(file, std::ios::binary),
        counters_(sensors.counters_present()),
        strain_(StrainColumns(sensors)),
        period_s_(period_s) {
    if (!stream_) throw InputError(file_ + ": cannot be opened; expected a CSV file");
  }

  std::vector<StepInput> Read() {
    ReadHeader();
    std::vector<StepInput> inputs;
    while (NextLine()) inputs.push_back(Input(inputs));
    if (inputs.empty()) Fail("found no rows, expected at least one sample");
    return inputs;
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(file_ + ":" + std::to_string(line_number_) + ": " + what);
  }

  [[noreturn]] void FailCell(const std::string& column, const std::string& expected) const {
    Fail(column + ": found \"" + std::string(Cell(column)) + "\", expected " + expected);
  }

  // Skips comments and empty lines.
  bool NextLine() {
    while (std::getline(stream_, line_)) {
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

  void ReadHeader() {
    if (!NextLine()) Fail("found an empty file, expected a header with the names of the columns");
    columns_ = cells_.size();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      if (!column_.emplace(cells_[i], i).second) {
        Fail("found column " + std::string(cells_[i]) + " twice, expected it once");
      }
    }
    std::vector<std::string> needed = {"time_s", "valid", "torque_1_nm", "torque_2_nm"};
    for (int i = 0; i < kCounters; ++i) {
      if ((counters_ >> i & 1U) != 0) needed.push_back("counter_" + std::to_string(i + 1));
    }
    needed.insert(needed.end(), strain_.begin(), strain_.end());
    for (const std::string& name : needed) {
      if (column_.find(name) == column_.end()) {
        Fail("found no column " + name + " in the header, expected it for this config");
      }
    }
  }

  std::string_view Cell(const std::string& name) const { return cells_[column_.at(name)]; }

  double Number(const std::string& name) const {
    const std::string_view cell = Cell(name);
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
      FailCell(name, "a number");
    }
    return value;
  }

  template <typename T>
  T Count(const std::string& name) const {
    const std::string_view cell = Cell(name);
    T value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size()) {
      FailCell(name, "a whole number of raw counts");
    }
    return value;
  }

  std::uint64_t ValidMask() const {
    const std::uint64_t all = AllMask(counters_, strain_.size());
    std::string_view cell = Cell("valid");
    if (cell == "1") return all;
    if (cell == "0") return 0;
    if (!cell.starts_with("0x")) FailCell("valid", "1, 0, or a mask as 0x..");
    cell.remove_prefix(2);
    std::uint64_t mask = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), mask, 16);
    if (error != std::errc() || end != cell.data() + cell.size() || (mask & ~all) != 0) {
      FailCell("valid", "a mask of the counters and channels of this config");
    }
    return mask;
  }

  void ReadFrame(SensorFrame* frame) const {
    for (std::size_t i = 0; i < kCounters; ++i) {
      if ((counters_ >> i & 1U) == 0) continue;
      frame->counter[i] = Count<std::uint32_t>("counter_" + std::to_string(i + 1));
    }
    for (std::size_t i = 0; i < strain_.size(); ++i) {
      frame->strain[i] = Count<std::int32_t>(strain_[i]);
    }
    const std::uint64_t mask = ValidMask();
    frame->counter_valid = static_cast<std::uint32_t>(mask & ((1U << kCounters) - 1));
    frame->strain_valid = static_cast<std::uint32_t>(mask >> kCounters);
    frame->levels = kHealthyLevels;
  }

  StepInput Input(const std::vector<StepInput>& before) {
    constexpr double kLongest_s = 1e8;  // three years: beyond it nanoseconds lose their meaning
    const double time_s = Number("time_s");
    if (std::abs(time_s) > kLongest_s) FailCell("time_s", "at most 1e8 s");
    StepInput input{};
    input.now_ns = std::llround(time_s * 1e9);
    input.sampling_instant_ns = input.now_ns;
    const double start_s =
        before.empty() ? time_s : static_cast<double>(before.front().now_ns) * 1e-9;
    input.tick = std::llround((time_s - start_s) / period_s_);
    if (!before.empty() && input.tick <= before.back().tick) {
      FailCell("time_s",
               "a time at least one period (" + Shortest(period_s_) + " s) after the row before");
    }
    ReadFrame(&input.frame);
    input.frame.sampled_at_ns = input.now_ns;
    input.applied_torque_nm = {Number("torque_1_nm"), Number("torque_2_nm")};
    input.safety_state = SafetyState::kRunning;
    input.reset = before.empty() ? 1 : 0;
    return input;
  }

  std::string file_;
  std::ifstream stream_;
  std::uint32_t counters_;
  std::vector<std::string> strain_;
  double period_s_;
  int line_number_ = 0;
  std::string line_;
  std::vector<std::string_view> cells_;
  std::size_t columns_ = 0;
  std::map<std::string, std::size_t, std::less<>> column_;
};

}  // namespace

std::vector<std::string> StrainColumns(const SensorConfig& sensors) {
  std::vector<std::string> names;
  std::map<int, int> seen;
  for (const StrainChannelConfig& channel : sensors.strain) {
    const std::string number = std::to_string(++seen[channel.link]);
    names.push_back("strain_" + std::to_string(channel.link) + "_" +
                    std::string(number.size() < 2 ? "0" : "") + number);
  }
  return names;
}

CsvWriter::CsvWriter(std::ostream* out, const SensorConfig& sensors, std::int64_t start_ns)
    : out_(out),
      counters_present_(sensors.counters_present()),
      strain_columns_(StrainColumns(sensors)),
      start_ns_(start_ns) {
  *out_ << "time_s";
  for (int i = 1; i <= kCounters; ++i) *out_ << ",counter_" << i;
  for (const std::string& name : strain_columns_) *out_ << ',' << name;
  *out_ << ",valid,torque_1_nm,torque_2_nm\n";
}

void CsvWriter::Row(const StepInput& input) {
  const SensorFrame& frame = input.frame;
  *out_ << Shortest(static_cast<double>(input.sampling_instant_ns - start_ns_) * 1e-9);
  for (const std::uint32_t count : frame.counter) *out_ << ',' << count;
  for (std::size_t i = 0; i < strain_columns_.size(); ++i) *out_ << ',' << frame.strain[i];
  *out_ << ',' << ValidText(frame, AllMask(counters_present_, strain_columns_.size()));
  for (const double torque : input.applied_torque_nm) *out_ << ',' << Shortest(torque);
  *out_ << '\n';
}

std::vector<StepInput> ReadCsv(const std::filesystem::path& file, const SensorConfig& sensors,
                               double period_s) {
  return Reader(file, sensors, period_s).Read();
}

}  // namespace flexarm
