// CSV files of other recorders: the conversion of their values, and each mistake with its place.

#include "controller/runlog/csv_import.h"

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

CsvImport Import() {
  const auto column = [](const char* name, double unit, double scale, const char* target) {
    return CsvColumn{.column = name, .unit = unit, .scale = scale, .offset = 0.0, .target = target};
  };
  CsvImport import{.decimation = 4, .column = {}};
  import.column = {column("t", 1e-3, 1.0, "time"),
                   column("a", kRadPerDeg, 1.0, "hub1"),
                   column("b", kRadPerDeg, 2.0, "hub2"),
                   column("i1", 1.0, 8.0, "torque_1"),
                   column("i2", 1.0, 0.5, "torque_2"),
                   column("g1", 1.0, 1.0, "strain_1_01"),
                   column("g2", kRadPerDeg, 100.0, "strain_2_01")};
  return import;
}

class CsvImportTest : public RunLogTest {
 protected:
  std::vector<StepInput> Read(const std::string& text, const CsvImport& import = Import()) {
    WriteText(File("data.csv"), text);
    return ReadAnyCsv(File("data.csv"), &import, OneGaugeALink(), 0.02);
  }
  void ExpectError(const std::string& text, const std::string& expected) {
    EXPECT_EQ(MessageOf<InputError>([&] { Read(text); }), File("data.csv").string() + expected);
  }
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
  ExpectError("t,a\n", ":1: found no column b in the header, expected it for this config");
  ExpectError(kForeignHeader, ":1: found no rows, expected at least one sample");
  ExpectError(kForeignHeader + "0,0,east,0,0,0,0,x\n", ":2: a: found \"east\", expected a number");
  ExpectError(kForeignHeader + "0,0,0,0,0,0,0,x\n0,6,0,0,0,0,0,x\n",
              ":3: t: found \"6\", expected 0.005 s: the rows are 0.005 s apart, loop.period_ms / "
              "csv.decimation");
  ExpectError(kForeignHeader + "0,0,0,0,0,0,x\n",
              ":2: found 7 values, expected 8 as in the header");
  ExpectError(kForeignHeader + "0,1e300,0,0,0,0,0,x\n",
              ":2: t: found \"1e300\", expected at most 1e8 s");
  ExpectError(kForeignHeader + "0,0,1e300,0,0,0,0,x\n",
              ":2: a: found \"1e300\", expected an angle within the range of this encoder");
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
