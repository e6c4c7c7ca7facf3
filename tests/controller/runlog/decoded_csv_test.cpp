// Decoded columns: the values are those of the log, the units those of the names, and the page
// about run logs lists exactly what the program writes.

#include "controller/runlog/decoded_csv.h"

#include <cmath>
#include <map>
#include <regex>
#include <set>

#include "controller/runlog/csv.h"
#include "controller/runlog/sqlite_db.h"
#include "model/units.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

SensorConfig Sensors() {
  SensorConfig sensors{};
  for (const int link : {1, 2}) {
    sensors.strain.push_back({.link = link,
                              .position_m = 0.1,
                              .face = link == 1 ? 1 : -1,
                              .gain_v_per_unit = 5000,
                              .offset_counts = 3});
  }
  sensors.strain_input = {.converter_bits = 12,
                          .range_v = 10.24,
                          .filter_hz = 0.0,
                          .noise_counts = 0.0,
                          .filter_damping = 0.0};  // 5 mV, so 1 microstrain, a count
  sensors.tip_accelerometer = {
      .range_m_s2 = 50.0, .converter_bits = 14, .noise_counts = 0.0, .filter_hz = 200.0};
  return sensors;
}

DecodedRun Everything() {
  return {.sensors = Sensors(),
          .tip = {.layout = kR12,
                  .length_m = {0.4, 0.3},
                  .tip_slope_per_m = {2.0, -5.0},
                  .settled_within_m = 0.007},
          .start_ns = kTestPeriodNs,
          .simulated = true,
          .timed = true,
          .with_raw = true};
}

std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

// The row of one sample, by the names of the columns.
std::map<std::string, std::string> Row(const DecodedRun& run, const DecodedSample& sample) {
  std::ostringstream out;
  DecodedCsvWriter(&out, run).Row(sample);
  std::istringstream in(out.str());
  std::string names, units, values;
  std::getline(in, names);
  std::getline(in, units);
  std::getline(in, values);
  const auto name = CellsOf(names), value = CellsOf(values);
  EXPECT_EQ(name.size(), CellsOf(units).size());
  EXPECT_EQ(name.size(), value.size());
  std::map<std::string, std::string> row;
  for (std::size_t i = 0; i < name.size(); ++i) row[name[i]] = value.at(i);
  return row;
}

using DecodedCsv = RunLogTest;

TEST_F(DecodedCsv, ValuesOfTheTickViewAreThoseOfTheLog) {
  TickRecord record = MakeTick(7);
  record.output.lyapunov_nm2 = std::numeric_limits<double>::quiet_NaN();
  {
    RunWriter writer(File(), MakeInfo());
    writer.Tick(record);
    writer.Close("");
  }
  SqliteDb log = SqliteDb::OpenReadOnly(File(), false);
  const TickRecord read = RunReader(File()).ReadAll().tick.at(0);
  const auto row = Row(Everything(), {read, nullptr});
  EXPECT_EQ(row.at("lyapunov_nm2"), "NaN");
  int compared = 0;
  for (const TickColumn& column : TickColumns()) {
    const std::string& cell = row.at(column.name);
    if (column.steps_per_unit == 0) continue;
    SqliteStatement value = log.Prepare(std::string("SELECT ") + column.name + " FROM tick");
    ASSERT_TRUE(value.Step());
    const double tolerance = column.steps_per_unit == 1 ? 0 : 0.5 / column.steps_per_unit;
    EXPECT_NEAR(std::stod(cell), value.Real(0), tolerance) << column.name;
    ++compared;
  }
  EXPECT_GT(compared, 12);
}

TEST_F(DecodedCsv, StrainsHaveOffsetGainFaceAndCalibration) {
  TickRecord record = MakeTick(7);
  record.input.frame.strain[0] = 103;
  record.input.frame.strain[1] = 103;
  auto row = Row(Everything(), {record, nullptr});
  EXPECT_NEAR(std::stod(row.at("strain_1_01_microstrain")), 100.0, 1e-9);
  EXPECT_NEAR(std::stod(row.at("strain_2_01_microstrain")), -100.0, 1e-9);
  EXPECT_EQ(row.at("strain_1_01"), "103");
  record.input.calibration.strain_zero_counts[0] = 20.0F;
  record.input.calibration.strain_gain_error[0] = 0.25F;
  row = Row(Everything(), {record, nullptr});
  EXPECT_NEAR(std::stod(row.at("strain_1_01_microstrain")), 64.0, 1e-9);
}

TEST_F(DecodedCsv, TheEstimateIsThatOfTheStep) {
  const TickRecord record = MakeTick(7);
  const DecodedRun run = Everything();
  const auto row = Row(run, {record, nullptr});
  const auto& x = record.output.x_hat;
  EXPECT_EQ(std::stod(row.at("estimated_hub_2_deg")), x[1] * kDegPerRad);
  EXPECT_EQ(std::stod(row.at("estimated_hub_rate_1_deg_s")), x[6] * kDegPerRad);
  EXPECT_EQ(std::stod(row.at("estimated_modal_22_m")), x[5]);
  EXPECT_EQ(std::stod(row.at("estimated_deflection_1_m")), x[2] + x[3]);
  EXPECT_EQ(std::stod(row.at("estimated_tip_y_m")), EstimatedTip(run.tip, x)[1]);
  EXPECT_EQ(std::stod(row.at("reference_rate_2_deg_s")),
            record.input.reference_now.x_m[7] * kDegPerRad);
  EXPECT_DOUBLE_EQ(std::stod(row.at("time_s")), 0.12);
}

TEST_F(DecodedCsv, TimesOfTheTaskAreNaNWhereTheyWereNotRecorded) {
  const TickRecord record = MakeTick(7);
  const TimingRecord timing{.tick = 7, .due_ns = 1000, .woke_ns = 3500, .finished_ns = 9500};
  const auto row = Row(Everything(), {record, &timing});
  EXPECT_EQ(row.at("late_us"), "2.5");
  EXPECT_EQ(row.at("took_us"), "6");
  EXPECT_EQ(Row(Everything(), {record, nullptr}).at("took_us"), "NaN");
}

TEST_F(DecodedCsv, ColumnsThatARunDoesNotHaveAreLeftOut) {
  DecodedRun rig = Everything();
  rig.simulated = rig.timed = rig.with_raw = false;
  rig.sensors.tip_accelerometer.reset();
  rig.tip.layout = kR8;
  std::set<std::string> left_out;
  for (const DecodedColumn& column : DecodedColumns(Everything())) left_out.insert(column.name);
  for (const DecodedColumn& column : DecodedColumns(rig)) left_out.erase(column.name);
  const std::set<std::string> expected = {"counter_1",
                                          "counter_2",
                                          "counter_3",
                                          "counter_4",
                                          "counter_valid",
                                          "estimated_modal_12_m",
                                          "estimated_modal_22_m",
                                          "late_us",
                                          "strain_1_01",
                                          "strain_2_01",
                                          "strain_valid",
                                          "tip_acceleration",
                                          "tip_acceleration_m_s2",
                                          "took_us",
                                          "truth_deflection_1_m",
                                          "truth_deflection_2_m",
                                          "truth_hub_1_rad",
                                          "truth_hub_2_rad",
                                          "truth_known",
                                          "truth_tip_x_m",
                                          "truth_tip_y_m"};
  EXPECT_EQ(left_out, expected);
}

TEST_F(DecodedCsv, ANameEndsInItsUnit) {
  const std::map<std::string, std::string> suffix = {{"deg", "_deg"},
                                                     {"rad", "_rad"},
                                                     {"deg/s", "_deg_s"},
                                                     {"m", "_m"},
                                                     {"s", "_s"},
                                                     {"N m", "_nm"},
                                                     {"kg", "_kg"},
                                                     {"ms", "_ms"},
                                                     {"us", "_us"},
                                                     {"m/s^2", "_m_s2"},
                                                     {"microstrain", "_microstrain"},
                                                     {"(N m)^2", "_nm2"}};
  const std::set<std::string> without = {"text",   "1",     "mixed", "samples",
                                         "0 or 1", "count", "bits"};
  for (const DecodedColumn& column : DecodedColumns(Everything())) {
    EXPECT_TRUE(without.contains(column.unit) ||
                (suffix.contains(column.unit) && column.name.ends_with(suffix.at(column.unit))))
        << column.name << ' ' << column.unit;
  }
}

// A channel stands on the page for all: LINK and NUMBER.
TEST_F(DecodedCsv, ThePageListsEveryColumnWithItsUnit) {
  const std::regex channel("strain_\\d_\\d\\d");
  std::map<std::string, std::string> written, listed;
  for (const DecodedColumn& column : DecodedColumns(Everything())) {
    written[std::regex_replace(column.name, channel, "strain_LINK_NUMBER")] = column.unit;
  }
  std::istringstream page(Bytes(FLEXARM_SOURCE_DIR "/docs/run-logs.md"));
  const std::regex row(R"(\| (`[^|]*) \| ([^|]*) \|.*)"), name("`(\\w+)`");
  bool in_section = false;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) in_section = line == "## Decoded columns";
    std::smatch cells;
    if (!in_section || !std::regex_match(line, cells, row)) continue;
    const std::string names = cells[1];
    for (std::sregex_iterator it(names.begin(), names.end(), name), end; it != end; ++it) {
      EXPECT_TRUE(listed.emplace((*it)[1], cells[2]).second) << (*it)[1] << " stands there twice";
    }
  }
  EXPECT_EQ(listed, written);
}

TEST_F(DecodedCsv, ThePageHasTheStepOfEveryColumnOfTheView) {
  std::map<std::string, std::string> step, listed;
  for (const TickColumn& column : TickColumns()) {
    std::ostringstream text;
    text << 1.0 / column.steps_per_unit;
    step[column.name] = column.steps_per_unit == 0 ? "-" : text.str();
  }
  step["state"] = "text";
  std::istringstream page(Bytes(FLEXARM_SOURCE_DIR "/docs/run-logs.md"));
  const std::regex row(R"(\| (`[^|]*) \| [^|]* \| ([^|]*) \| [^|]* \|)"), name("`(\\w+)`");
  for (std::string line; std::getline(page, line);) {
    std::smatch cells;
    if (!std::regex_match(line, cells, row)) continue;
    const std::string names = cells[1];
    for (std::sregex_iterator it(names.begin(), names.end(), name), end; it != end; ++it) {
      if (step.contains((*it)[1])) listed[(*it)[1]] = cells[2];
    }
  }
  for (auto& [column, text] : step) {
    text = text == "0.0001" ? "1e-4" : text == "1e-06" ? "1e-6" : text;
  }
  EXPECT_EQ(listed, step);
}

TEST_F(DecodedCsv, AReplayOfItSaysWhatToDo) {
  std::ostringstream out;
  DecodedCsvWriter(&out, Everything()).Row({MakeTick(1), nullptr});
  WriteText(File("values.csv"), out.str());
  EXPECT_TRUE(out.str().starts_with(kDecodedMark));
  EXPECT_EQ(MessageOf<InputError>([&] { ReadCsv(File("values.csv"), Sensors(), 0.02); }),
            File("values.csv").string() +
                ":1: found decoded columns, expected raw counts: write them with `flexarm export "
                "RUN -o FILE.csv`, without --decoded");
}

}  // namespace
}  // namespace flexarm
