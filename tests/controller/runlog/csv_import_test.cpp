// CSV files of other recorders: the conversion of their values, and each mistake with its place.

#include "controller/runlog/csv_import.h"

#include <gmock/gmock.h>

#include "controller/runlog/csv.h"
#include "model/units.h"
#include "tests/controller/runlog/runlog_fixture.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

SensorConfig OneGaugeALink() {
  SensorConfig sensors{};
  for (const int hub : {0, 1}) {
    sensors.encoder.push_back(
        {.counter = hub, .counts_per_turn = 3600, .counter_bits = 8, .sign = hub == 0 ? 1 : -1});
  }
  for (const int link : {1, 2}) {
    sensors.strain.push_back(
        {.link = link, .position_m = 0.1, .face = -1, .gain_v_per_unit = 5000, .offset_counts = 3});
  }
  sensors.strain_input = {.converter_bits = 12,
                          .range_v = 10.24,
                          .filter_hz = 0.0,
                          .noise_counts = 0.0,
                          .filter_damping = 0.0};  // 5 mV a count
  return sensors;
}

CsvUnit Unit(std::string_view name) {
  for (const CsvUnit& unit : kCsvUnits) {
    if (unit.name == name) return unit;
  }
  ADD_FAILURE() << "no unit " << name;
  return kCsvUnits[0];
}

CsvImport Import() {
  const auto column = [](const char* name, const char* unit, double scale, const char* target) {
    return CsvColumn{
        .column = name, .unit = Unit(unit), .scale = scale, .offset = 0.0, .target = target};
  };
  CsvImport import{.decimation = 4};
  import.column = {column("t", "ms", 1.0, "time"),           column("a", "deg", 1.0, "hub1"),
                   column("b", "deg", 2.0, "hub2"),          column("i1", "A", 8.0, "torque_1"),
                   column("i2", "A", 0.5, "torque_2"),       column("g1", "V", 1.0, "strain_1_01"),
                   column("g2", "deg", 100.0, "strain_2_01")};
  return import;
}

CsvImport Resampling() {
  CsvImport import = Import();
  import.resample = true;
  return import;
}

class CsvImportTest : public RunLogTest {
 protected:
  std::vector<StepInput> Read(const std::string& text, const CsvImport& import = Import()) {
    WriteText(File("data.csv"), text);
    run_ = ReadAnyCsv(File("data.csv"), &import, OneGaugeALink(), 0.02);
    return run_.input;
  }
  void ExpectError(const std::string& text, const std::string& expected,
                   const CsvImport& import = Import()) {
    EXPECT_EQ(MessageOf<InputError>([&] { Read(text, import); }),
              File("data.csv").string() + expected);
  }

  CsvRun run_;  // of the last Read
};

const std::string kForeignHeader = "g2,t,a,b,i1,i2,g1,comment\n";

TEST_F(CsvImportTest, EveryDecimationthRowIsATick) {
  std::string text = kForeignHeader;
  for (int row = 0; row < 10; ++row) {  // 5 ms apart
    text += "0," + std::to_string(100 + 5 * row) + ",0,0," + std::to_string(row) + ",0,0,x\n";
  }
  const std::vector<StepInput> inputs = Read(text);
  ASSERT_EQ(inputs.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(inputs[k].tick, static_cast<std::int64_t>(k));
    EXPECT_EQ(inputs[k].now_ns, 100'000'000 + static_cast<std::int64_t>(k) * 20'000'000);
    EXPECT_EQ(inputs[k].reset, k == 0 ? 1 : 0);
  }
  // A current that rises by 1 a row: its mean over rows 0 to 4 is 2, over 4 to 8 is 6.
  EXPECT_EQ(inputs[0].applied_torque_nm[0], 0.0);
  EXPECT_DOUBLE_EQ(inputs[1].applied_torque_nm[0], 8.0 * 2.0);
  EXPECT_DOUBLE_EQ(inputs[2].applied_torque_nm[0], 8.0 * 6.0);
}

TEST_F(CsvImportTest, NumbersBecomeConverterReadings) {
  CsvImport import = Import();
  import.column[3].offset = 0.25;
  const StepInput input = Read(kForeignHeader + "0.1,0,-12.54,13,-1,4,0.0124,x\n", import).at(0);
  // 10 counts a degree: -125.4 of 8 bits; the second encoder counts clockwise, and its column
  // twice.
  EXPECT_EQ(input.frame.counter[0], 256U - 125U);
  EXPECT_EQ(input.frame.counter[1], 512U - 260U);
  // 12.4 mV are 2.48 counts; 0.1 deg x 100 V/rad are 0.17453 V. The voltage is that at the
  // converter: faces, gains and offsets of the channels are not applied again.
  EXPECT_EQ(input.frame.strain[0], 2);
  EXPECT_EQ(input.frame.strain[1], 35);
  EXPECT_EQ(input.frame.counter_valid, 0b11U);
  EXPECT_EQ(input.frame.strain_valid, 0b11U);
  EXPECT_DOUBLE_EQ(input.applied_torque_nm[0], -7.75);
  EXPECT_DOUBLE_EQ(input.applied_torque_nm[1], 2.0);
}

TEST_F(CsvImportTest, VoltagesBeyondTheRailsSaturate) {
  EXPECT_EQ(Read(kForeignHeader + "0,0,0,0,0,0,1e9,x\n").at(0).frame.strain[0], 2047);
  EXPECT_EQ(Read(kForeignHeader + "0,0,0,0,0,0,-1e9,x\n").at(0).frame.strain[0], -2048);
}

TEST_F(CsvImportTest, FilesInOurOwnFormatAreRecognised) {
  std::ostringstream out;
  CsvWriter writer(&out, OneGaugeALink(), 0);
  StepInput input{};
  input.frame.counter = {7, 9, 0, 0};
  input.frame.counter_valid = input.frame.strain_valid = 0b11;
  writer.Row(input);
  EXPECT_EQ(Read(out.str()).at(0).frame.counter[1], 9U);
}

TEST_F(CsvImportTest, MistakesAreNamedWithTheirPlace) {
  ExpectError("t,a\n",
              ":1: found no column b in the header, expected it for this config; also missing: i1, "
              "i2, g1, g2");
  ExpectError(kForeignHeader, ":1: found no rows, expected at least one sample");
  ExpectError(kForeignHeader + "0,0,east,0,0,0,0,x\n", ":2: a: found \"east\", expected a number");
  ExpectError(kForeignHeader + "0,0,0,0,0,0,x\n",
              ":2: found 7 values, expected 8 as in the header");
  ExpectError(kForeignHeader + "0,1e300,0,0,0,0,0,x\n",
              ":2: t: found \"1e300\", expected at most 1e8 s");
  ExpectError(kForeignHeader + "0,0,1e300,0,0,0,0,x\n",
              ":2: a: found 1.74533e+298 rad, expected an angle within the range of this encoder");
  EXPECT_THAT(MessageOf<InputError>([&] {
                WriteText(File("data.csv"), kForeignHeader);
                ReadAnyCsv(File("data.csv"), nullptr, OneGaugeALink(), 0.02);
              }),
              testing::HasSubstr("a config with a table [csv]"));
}

std::string TimedRow(double time_ms, double angle_deg = 0.0) {
  return "0," + CsvNumber(time_ms) + "," + CsvNumber(angle_deg) + ",0,0,0,0,x\n";
}

TEST_F(CsvImportTest, TimesThatAreNotThoseOfTheLoopAreNamedWithTheWayOut) {
  const std::string advice = "; `csv.resample = true` interpolates the rows on the loop's samples";
  const std::string asked = "they should be 0.005 s, 200 Hz, by loop.period_ms / csv.decimation";
  ExpectError(kForeignHeader + TimedRow(0) + TimedRow(6) + TimedRow(12),
              ":3: t: found 0.006 s, expected 0.005 s: the rows are 0.006 s apart, 166.667 Hz, and "
              "should be 0.005 s, 200 Hz, by loop.period_ms / csv.decimation" +
                  advice);
  ExpectError(kForeignHeader + TimedRow(0) + TimedRow(10) + TimedRow(20),
              ":3: t: found 0.01 s, expected 0.005 s: the rows are 0.01 s apart, 100 Hz, and "
              "should be 0.005 s, 200 Hz, by loop.period_ms / csv.decimation: set csv.decimation = "
              "2, if that is the rate it was recorded at" +
                  advice);
  ExpectError(
      kForeignHeader + TimedRow(0) + TimedRow(5) + TimedRow(10) + TimedRow(25) + TimedRow(30),
      ":5: t: found 0.025 s, expected 0.015 s: rows are missing before this one; " + asked +
          advice);
  ExpectError(kForeignHeader + TimedRow(0) + TimedRow(5) + TimedRow(11) + TimedRow(15),
              ":4: t: found 0.011 s, expected 0.01 s: the times are uneven; " + asked + advice);
  for (const double time_ms : {5.0, 1.0}) {
    ExpectError(kForeignHeader + TimedRow(0) + TimedRow(5) + TimedRow(time_ms) + TimedRow(10),
                ":4: t: found " + CsvNumber(1e-3 * time_ms) +
                    " s, expected a time after that of the row before, 0.005 s; `csv.resample = "
                    "true` leaves such rows out");
  }
  ExpectError(kForeignHeader + "0,0,0,0,0,0,,x\n", ":2: g1: found \"\", expected a number" +
                                                       advice + " and counts this one as not read");
}

TEST_F(CsvImportTest, OnRequestRowsAreInterpolatedOnTheLoopsSamples) {
  // 1 deg a ms and a current that rises by 1 a ms, at uneven times, one of them twice.
  std::string text = kForeignHeader;
  for (const int ms : {0, 7, 13, 13, 29, 33, 47, 41, 60, 66}) {
    const std::string value = std::to_string(ms);
    text += "0," + value + "," + value + ",0," + value + ",0,0,x\n";
  }
  const std::vector<StepInput> inputs = Read(text, Resampling());
  ASSERT_EQ(inputs.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(inputs[k].tick, static_cast<std::int64_t>(k));
    EXPECT_EQ(inputs[k].frame.counter[0], (200 * k) % 256U) << k;  // 10 counts a degree, 8 bits
    EXPECT_EQ(inputs[k].frame.strain_valid, 0b11U);
    // The mean over the 20 ms before, 8 N m per A.
    EXPECT_NEAR(inputs[k].applied_torque_nm[0],
                k == 0 ? 0.0 : 8.0 * (20.0 * static_cast<double>(k) - 10.0), 1e-9);
  }
  ASSERT_TRUE(run_.facts.resampling);
  EXPECT_EQ(run_.facts.resampling->rows_left_out, 2);
  EXPECT_EQ(run_.facts.resampling->samples_not_read, 0);
  EXPECT_EQ(run_.facts.resampling->longest_gap_s, 0.04);
}

TEST_F(CsvImportTest, BeyondTheLongestGapASensorIsNotRead) {
  std::string text = kForeignHeader;
  for (int ms = 0; ms <= 400; ms += 10) {
    if (ms > 100 && ms < 180) continue;                               // rows are missing
    const std::string gauge = ms > 250 && ms < 300 ? "NaN" : "0.05";  // a gauge has no reading
    text += "0," + std::to_string(ms) + ",0,0,0,0," + gauge + ",x\n";
  }
  const std::vector<StepInput> inputs = Read(text, Resampling());
  ASSERT_EQ(inputs.size(), 21U);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const bool rows = k <= 5 || k >= 9, gauge = rows && (k <= 12 || k >= 15);
    EXPECT_EQ(inputs[k].frame.counter_valid, rows ? 0b11U : 0U) << k;
    EXPECT_EQ(inputs[k].frame.strain_valid, (rows ? 0b10U : 0U) | (gauge ? 0b1U : 0U)) << k;
  }
  EXPECT_EQ(run_.facts.resampling->samples_not_read, 5);
  EXPECT_NEAR(run_.facts.resampling->longest_missing_s, 0.08, 1e-9);
  CsvImport wider = Resampling();
  wider.longest_gap_s = 0.1;
  Read(text, wider);
  EXPECT_EQ(run_.facts.resampling->samples_not_read, 0);
  wider.longest_gap_s = 0.005;
  ExpectError(text,
              ":2: found rows 0.01 s apart, expected at most csv.longest_gap_s = 0.005 s, beyond "
              "which nothing is read",
              wider);
  ExpectError(kForeignHeader + TimedRow(0) + TimedRow(10) + TimedRow(2e6),
              ":4: found no rows for 1999.99 s before this one, expected at most 600 s: cut the "
              "file here",
              Resampling());
}

TEST_F(CsvImportTest, ARowOfUnitsIsSkippedAndMustAgree) {
  EXPECT_EQ(Read(kForeignHeader + "[deg],[ms],[deg],deg,(A),,volts,\n" + TimedRow(0, 12.0))
                .at(0)
                .frame.counter[0],
            120U);
  EXPECT_TRUE(run_.facts.units_row);
  ExpectError(kForeignHeader + "deg,s,deg,deg,A,A,V,\n" + TimedRow(0),
              ":2: t: found \"s\", expected the unit \"ms\" that csv.column has for it: change it "
              "there");
  ExpectError(kForeignHeader + TimedRow(0) + "deg,ms,deg,deg,A,A,V,\n",
              ":3: t: found \"ms\", expected a number");
}

TEST_F(CsvImportTest, SemicolonsWithDecimalCommasAreRead) {
  const std::string text =
      "sep=;\n\"g2\";t;\"a\";b;i1;i2;g1;\"a \"\"comment\"\"; quoted\"\n"
      "0;0,0;-12,54;0;+1,5;0;0;\"x;y\"\n";
  const StepInput input = Read(text).at(0);
  EXPECT_EQ(input.frame.counter[0], 256U - 125U);
  EXPECT_DOUBLE_EQ(input.applied_torque_nm[0], 12.0);
  EXPECT_EQ(run_.facts.separator, ';');
  EXPECT_TRUE(run_.facts.decimal_comma);
  EXPECT_EQ(run_.facts.unused, std::vector<std::string>{"a \"comment\"; quoted"});
  EXPECT_EQ(run_.facts.used.size(), 7U);
  ExpectError("g2;t;a;b;i1;i2;g1\n0;0,0;1.5;0;0;0;0\n",
              ":2: a: found \"1.5\", expected a decimal comma, as in line 2");
  ExpectError("g2;t;a;b;i1;i2;g1\n0;0;1.234,5;0;0;0;0\n",
              ":2: a: found \"1.234,5\", expected a number without separators between thousands");
}

TEST_F(CsvImportTest, TabsMarksAndLineEndsOfOtherSystemsAreRead) {
  const std::string text =
      "\xEF\xBB\xBF% a recorder\r\ng2\tt\ta\tb\ti1\ti2\tg1\tnote\r\n// "
      "begins\r\n0\t0\t12\t0\t1\t0\t"
      "0\t\r\n";
  EXPECT_EQ(Read(text).at(0).frame.counter[0], 120U);
  EXPECT_EQ(run_.facts.separator, '\t');
}

TEST_F(CsvImportTest, AHeaderWithTwoSeparatorsNeedsToBeTold) {
  const std::string text = "g2;t;a;b;i1;i2;g1;x,y\n0;0;1;0;0;0;0;0\n";
  EXPECT_THAT(MessageOf<InputError>([&] { Read(text); }),
              testing::AllOf(testing::HasSubstr(":1: found commas and semicolons in the header"),
                             testing::HasSubstr("csv.separator")));
  CsvImport told = Import();
  told.separator = ';';
  EXPECT_EQ(Read(text, told).size(), 1U);
  ExpectError(kForeignHeader + TimedRow(0),
              ":1: found commas between the columns, expected the separator \";\" that was stated",
              told);
  ExpectError("g2 t a b\n0 0 0 0\n",
              ":1: found spaces in the header, expected commas, semicolons or tabs between the "
              "columns");
  ExpectError(kForeignHeader + "0,0,\"1,0,0,0,0,x\n",
              ":2: found a quote without a second one on the line, expected each cell on one line");
}

TEST(CsvImportRules, EverySensorAndTorqueNeedsExactlyOneColumn) {
  EXPECT_TRUE(ProblemsOf(Import(), OneGaugeALink()).empty());
  CsvImport import = Import();
  import.decimation = 0;
  import.column[1].scale = 0.0;
  import.column[2].target = "hub3";
  import.column[4].target = "torque_1";
  import.column[3].column = "";
  std::vector<std::string> keys;
  for (const Problem& problem : ProblemsOf(import, OneGaugeALink())) keys.push_back(problem.key);
  EXPECT_EQ(keys, (std::vector<std::string>{"csv.decimation", "csv.column[1].scale",
                                            "csv.column[2].target", "csv.column[3].column",
                                            "csv.column[4].target", "csv.column", "csv.column"}));
}

}  // namespace
}  // namespace flexarm
