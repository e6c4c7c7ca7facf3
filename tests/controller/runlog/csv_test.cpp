// CSV: an exported file reads back exactly, and each mistake in a file is named with its place.

#include "controller/runlog/csv.h"

#include "controller/runlog/blob.h"
#include "tests/controller/runlog/runlog_fixture.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

SensorConfig TwoAndOneChannels() {
  SensorConfig sensors{};
  for (int counter = 0; counter < 3; ++counter) {  // the fourth does not exist
    sensors.encoder.push_back(
        {.counter = counter, .counts_per_turn = 2540, .counter_bits = 16, .sign = 1});
  }
  for (const int link : {1, 2, 1}) {
    sensors.strain.push_back(
        {.link = link, .position_m = 0.1, .face = 1, .gain_v_per_unit = 5000, .offset_counts = 0});
  }
  return sensors;
}

constexpr const char* kHeader =
    "time_s,counter_1,counter_2,counter_3,counter_4,strain_1_01,strain_2_01,strain_1_02,valid,"
    "torque_1_nm,torque_2_nm\n";

class CsvTest : public RunLogTest {
 protected:
  std::vector<StepInput> Read(const std::string& text) {
    WriteText(File("data.csv"), text);
    return ReadCsv(File("data.csv"), TwoAndOneChannels(), 0.02);
  }
  void ExpectError(const std::string& text, const std::string& expected) {
    EXPECT_EQ(MessageOf<InputError>([&] { Read(text); }), File("data.csv").string() + expected);
  }
};

StepInput Sample(std::int64_t tick) {
  StepInput input = MakeTick(tick).input;
  input.frame.counter[3] = 0;
  input.frame.counter_valid = 0x7;
  input.frame.strain_valid = 0x7;
  return input;
}

TEST_F(CsvTest, AWrittenFileReadsBackExactly) {
  std::ostringstream out;
  CsvWriter writer(&out, TwoAndOneChannels(), 7 * kTestPeriodNs);
  std::vector<StepInput> written = {Sample(7), Sample(8), Sample(10)};
  written[0].applied_torque_nm = {-0.0, 1e-300};
  written[1].frame.strain_valid = 0x5;
  written[2].frame.strain_valid = 0;
  written[2].frame.counter_valid = 0;
  for (const StepInput& input : written) writer.Row(input);
  EXPECT_EQ(out.str().substr(0, out.str().find('\n') + 1), kHeader);

  const std::vector<StepInput> read = Read(out.str());
  ASSERT_EQ(read.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].tick, written[i].tick - 7);
    EXPECT_EQ(read[i].now_ns, written[i].now_ns - 7 * kTestPeriodNs);
    EXPECT_EQ(read[i].frame.counter, written[i].frame.counter);
    EXPECT_EQ(read[i].frame.counter_valid, written[i].frame.counter_valid);
    EXPECT_EQ(read[i].frame.strain_valid, written[i].frame.strain_valid);
    for (std::size_t n = 0; n < 3; ++n) {
      EXPECT_EQ(read[i].frame.strain[n], written[i].frame.strain[n]);
    }
    EXPECT_TRUE(SameBytes(read[i].applied_torque_nm, written[i].applied_torque_nm));
    EXPECT_EQ(read[i].reset, i == 0 ? 1 : 0);
    EXPECT_EQ(read[i].safety_state, SafetyState::kRunning);
  }
}

TEST_F(CsvTest, ATipAccelerometerHasItsColumnAndItsBit) {
  SensorConfig sensors = TwoAndOneChannels();
  sensors.tip_accelerometer = {
      .range_m_s2 = 50.0, .converter_bits = 14, .noise_counts = 0.0, .filter_hz = 200.0};
  std::vector<StepInput> written = {Sample(0), Sample(1), Sample(2)};
  written[0].frame.accelerometer[0] = -8000;
  written[0].frame.accelerometer_valid = written[2].frame.accelerometer_valid = 1;
  written[2].frame.strain_valid = 0x3;
  std::ostringstream out;
  CsvWriter writer(&out, sensors, 0);
  for (const StepInput& input : written) writer.Row(input);
  WriteText(File("tip.csv"), out.str());
  const std::vector<StepInput> read = ReadCsv(File("tip.csv"), sensors, 0.02);
  ASSERT_EQ(read.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read[i].frame.accelerometer, written[i].frame.accelerometer);
    EXPECT_EQ(read[i].frame.accelerometer_valid, written[i].frame.accelerometer_valid) << i;
    EXPECT_EQ(read[i].frame.strain_valid, written[i].frame.strain_valid) << i;
    EXPECT_EQ(read[i].frame.counter_valid, written[i].frame.counter_valid) << i;
  }
  WriteText(File("none.csv"), kHeader);
  EXPECT_EQ(MessageOf<InputError>([&] { ReadCsv(File("none.csv"), sensors, 0.02); }),
            File("none.csv").string() +
                ":1: found no column tip_acceleration in the header, expected it for this config");
}

TEST_F(CsvTest, ColumnsMayComeInAnyOrderWithOthersBetween) {
  const auto read = Read(
      "# from elsewhere\r\ntorque_2_nm, note, time_s,valid,counter_1,counter_2,counter_3,"
      "strain_1_01,strain_1_02,strain_2_01,torque_1_nm\r\n"
      "\r\n-1.5, hello, 4.02,1,65535,0,0,-2048,7,9,2\r\n");
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].frame.counter[0], 65535U);
  EXPECT_EQ(read[0].frame.strain[0], -2048);
  EXPECT_EQ(read[0].frame.strain[1], 9);  // the order of the config, not of the file
  EXPECT_EQ(read[0].frame.strain[2], 7);
  EXPECT_EQ(read[0].applied_torque_nm[1], -1.5);
}

TEST_F(CsvTest, AMissingColumnIsNamed) {
  ExpectError("time_s,valid,torque_1_nm,torque_2_nm,counter_1,counter_2,counter_3,strain_1_01\n",
              ":1: found no column strain_2_01 in the header, expected it for this config; also "
              "missing: strain_1_02");
}

TEST_F(CsvTest, AColumnTwiceIsNamed) {
  ExpectError("time_s,valid,time_s\n", ":1: found column time_s twice, expected it once");
}

TEST_F(CsvTest, ARaggedRowIsNamed) {
  ExpectError(std::string(kHeader) + "0,0,0,0,0,0,0,0,1,0,0\n0.02,0,0\n",
              ":3: found 3 values, expected 11 as in the header");
}

TEST_F(CsvTest, AValueThatIsNotANumberIsNamed) {
  ExpectError(std::string(kHeader) + "0,0,0,0,0,0,0,0,1,abc,0\n",
              ":2: torque_1_nm: found \"abc\", expected a number");
  ExpectError(std::string(kHeader) + "0,0,0,0,0,0,0,0,1,nan,0\n",
              ":2: torque_1_nm: found \"nan\", expected a number");
  ExpectError(std::string(kHeader) + "0,0,-3,0,0,0,0,0,1,0,0\n",
              ":2: counter_2: found \"-3\", expected a whole number of raw counts");
  ExpectError(std::string(kHeader) + "0,0,0,0,0,0.5,0,0,1,0,0\n",
              ":2: strain_1_01: found \"0.5\", expected a whole number of raw counts");
}

TEST_F(CsvTest, AWrongValidIsNamed) {
  ExpectError(std::string(kHeader) + "0,0,0,0,0,0,0,0,yes,0,0\n",
              ":2: valid: found \"yes\", expected 1, 0, or a mask as 0x..");
  ExpectError(std::string(kHeader) + "0,0,0,0,0,0,0,0,0xfff,0,0\n",
              ":2: valid: found \"0xfff\", expected a mask of the counters and channels of this "
              "config");
}

TEST_F(CsvTest, TimeThatDoesNotIncreaseIsNamed) {
  ExpectError(std::string(kHeader) + "0,0,0,0,0,0,0,0,1,0,0\n0.001,0,0,0,0,0,0,0,1,0,0\n",
              ":3: time_s: found \"0.001\", expected a time at least one period (0.02 s) after the "
              "row before");
}

TEST_F(CsvTest, AFileWithoutRowsIsNamed) {
  ExpectError("", ":0: found an empty file, expected a header with the names of the columns");
  ExpectError(kHeader, ":1: found no rows, expected at least one sample");
}

TEST_F(CsvTest, HalfAPeriodOfOffsetDoesNotMergeRows) {
  std::string text = kHeader;
  for (int i = 0; i < 1000; ++i) {
    text += std::to_string(0.01 + 0.02 * i) + ",0,0,0,0,0,0,0,1,0,0\n";
  }
  const auto read = Read(text);
  EXPECT_EQ(read.back().tick, 999);
}

}  // namespace
}  // namespace flexarm
