#include "controller/runlog/csv.h"

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

namespace flexarm {
namespace {

constexpr const char* kTipColumn = "tip_acceleration";

// Bits of the column `valid`: counters, strain channels in config order, the accelerometer.
std::uint64_t TipBit(std::size_t channels) { return std::uint64_t{1} << (kCounters + channels); }

std::uint64_t AllMask(const SensorConfig& sensors) {
  const std::uint64_t tip_bit = TipBit(sensors.strain.size());
  const std::uint64_t strain = tip_bit - (std::uint64_t{1} << kCounters);
  return sensors.counters_present() | strain | (sensors.tip_accelerometer ? tip_bit : 0);
}

std::string ValidText(const SensorFrame& frame, std::size_t channels, std::uint64_t all) {
  const std::uint64_t strain = frame.strain_valid;
  const std::uint64_t tip = frame.accelerometer_valid != 0 ? TipBit(channels) : 0;
  const std::uint64_t mask = (frame.counter_valid | (strain << kCounters) | tip) & all;
  if (mask == all) return "1";
  if (mask == 0) return "0";
  std::array<char, 20> text;
  const auto [end, error] = std::to_chars(text.begin(), text.end(), mask, 16);
  return "0x" + std::string(text.begin(), end);
}

// Reads one CSV file of our own format, row by row.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const SensorConfig& sensors, double period_s)
      : table_(file),
        counters_(sensors.counters_present()),
        has_tip_(sensors.tip_accelerometer.has_value()),
        all_(AllMask(sensors)),
        strain_(StrainColumns(sensors)),
        period_s_(period_s) {
    if (IsDecoded(table_)) {
      table_.Fail("found decoded columns, expected raw counts: write them with " +
                  std::string("`flexarm export RUN -o FILE.csv`, without --decoded"));
    }
    table_.Need(OwnColumns(sensors));
  }

  std::vector<StepInput> Read() {
    std::vector<StepInput> inputs;
    while (table_.Next()) inputs.push_back(Input(inputs));
    if (inputs.empty()) table_.Fail("found no rows, expected at least one sample");
    return inputs;
  }

 private:
  std::uint64_t ValidMask() const {
    const std::string_view cell = table_.Cell("valid");
    if (cell == "1") return all_;
    if (cell == "0") return 0;
    if (!cell.starts_with("0x")) table_.FailCell("valid", "1, 0, or a mask as 0x..");
    const std::string expected = "a mask of the counters and channels of this config";
    const auto mask = table_.Whole<std::uint64_t>("valid", expected, 16, 2);
    if ((mask & ~all_) != 0) table_.FailCell("valid", expected);
    return mask;
  }

  void ReadFrame(SensorFrame* frame) const {
    const std::string expected = "a whole number of raw counts";
    for (std::size_t i = 0; i < kCounters; ++i) {
      if ((counters_ >> i & 1U) == 0) continue;
      frame->counter[i] = table_.Whole<std::uint32_t>("counter_" + std::to_string(i + 1), expected);
    }
    for (std::size_t i = 0; i < strain_.size(); ++i) {
      frame->strain[i] = table_.Whole<std::int32_t>(strain_[i], expected);
    }
    const std::uint64_t mask = ValidMask();
    frame->counter_valid = static_cast<std::uint32_t>(mask & ((1U << kCounters) - 1));
    const std::uint64_t tip_bit = TipBit(strain_.size());
    frame->strain_valid = static_cast<std::uint32_t>((mask & (tip_bit - 1)) >> kCounters);
    if (!has_tip_) return;
    frame->accelerometer[0] = table_.Whole<std::int32_t>(kTipColumn, expected);
    frame->accelerometer_valid = (mask & tip_bit) != 0 ? 1 : 0;
  }

  StepInput Input(const std::vector<StepInput>& before) {
    const double time_s = table_.Number("time_s");
    if (std::abs(time_s) > kLongestCsv_s) table_.FailCell("time_s", "at most 1e8 s");
    StepInput input = CsvInput(time_s, period_s_, before);
    if (!before.empty() && input.tick <= before.back().tick) {
      table_.FailCell("time_s", "a time at least one period (" + CsvNumber(period_s_) +
                                    " s) after the row before");
    }
    ReadFrame(&input.frame);
    input.applied_torque_nm = {table_.Number("torque_1_nm"), table_.Number("torque_2_nm")};
    return input;
  }

  CsvTable table_;
  std::uint32_t counters_;
  bool has_tip_;
  std::uint64_t all_;
  std::vector<std::string> strain_;
  double period_s_;
};

}  // namespace

std::string CsvNumber(double value) {
  std::array<char, 40> text;
  const auto [end, error] = std::to_chars(text.begin(), text.end(), value);
  return error == std::errc() ? std::string(text.begin(), end) : std::string("nan");
}

bool IsDecoded(const CsvTable& table) {
  return table.Has("tick") && table.Has("state") && table.Has("torque_applied_1_nm") &&
         !table.Has("torque_1_nm");
}

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

std::vector<std::string> OwnColumns(const SensorConfig& sensors) {
  std::vector<std::string> names = {"time_s", "valid", "torque_1_nm", "torque_2_nm"};
  for (int i = 0; i < kCounters; ++i) {
    if ((sensors.counters_present() >> i & 1U) != 0)
      names.push_back("counter_" + std::to_string(i + 1));
  }
  const std::vector<std::string> strain = StrainColumns(sensors);
  names.insert(names.end(), strain.begin(), strain.end());
  if (sensors.tip_accelerometer) names.emplace_back(kTipColumn);
  return names;
}

CsvWriter::CsvWriter(std::ostream* out, const SensorConfig& sensors, std::int64_t start_ns)
    : out_(out),
      strain_columns_(StrainColumns(sensors)),
      has_tip_(sensors.tip_accelerometer.has_value()),
      readings_(AllMask(sensors)),
      start_ns_(start_ns) {
  *out_ << "time_s";
  for (int i = 1; i <= kCounters; ++i) *out_ << ",counter_" << i;
  for (const std::string& name : strain_columns_) *out_ << ',' << name;
  if (has_tip_) *out_ << ',' << kTipColumn;
  *out_ << ",valid,torque_1_nm,torque_2_nm\n";
}

void CsvWriter::Row(const StepInput& input) {
  const SensorFrame& frame = input.frame;
  *out_ << CsvNumber(static_cast<double>(input.sampling_instant_ns - start_ns_) * 1e-9);
  for (const std::uint32_t count : frame.counter) *out_ << ',' << count;
  for (std::size_t i = 0; i < strain_columns_.size(); ++i) *out_ << ',' << frame.strain[i];
  if (has_tip_) *out_ << ',' << frame.accelerometer[0];
  *out_ << ',' << ValidText(frame, strain_columns_.size(), readings_);
  for (const double torque : input.applied_torque_nm) *out_ << ',' << CsvNumber(torque);
  *out_ << '\n';
}

StepInput CsvInput(double time_s, double period_s, const std::vector<StepInput>& before) {
  StepInput input{};
  input.now_ns = std::llround(time_s * 1e9);
  input.sampling_instant_ns = input.now_ns;
  const double start_s =
      before.empty() ? time_s : static_cast<double>(before.front().now_ns) * 1e-9;
  input.tick = std::llround((time_s - start_s) / period_s);
  input.frame.sampled_at_ns = input.now_ns;
  input.frame.levels = kHealthyLevels;
  input.safety_state = SafetyState::kRunning;
  input.reset = before.empty() ? 1 : 0;
  return input;
}

std::vector<StepInput> ReadCsv(const std::filesystem::path& file, const SensorConfig& sensors,
                               double period_s) {
  return Reader(file, sensors, period_s).Read();
}

}  // namespace flexarm
