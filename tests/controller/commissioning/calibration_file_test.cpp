#include "controller/commissioning/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "controller/runlog/errors.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

class CalibrationFileTest : public testing::Test {
 protected:
  CalibrationFileTest() { std::filesystem::remove_all(folder_); }
  ~CalibrationFileTest() override { std::filesystem::remove_all(folder_); }

  void Put(const std::string& text) const {
    std::filesystem::create_directories(folder_);
    std::ofstream(file_) << text;
  }
  std::string Refusal() const {
    return MessageOf<InputError>([this] { ReadCalibration(file_, config_.sensors); });
  }

  const RigConfig config_ = ShippedRig();
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::filesystem::path file_ = folder_ / "calibration.json";
};

TEST_F(CalibrationFileTest, ReadsBackWhatWasWritten) {
  Calibration calibration{};
  calibration.counter_zero = {1, -2, 250, 4};
  for (std::size_t i = 0; i < 20; ++i) {
    calibration.strain_zero_counts[i] = 0.1f * static_cast<float>(i);
    calibration.strain_gain_error[i] = -0.01f * static_cast<float>(i);
  }
  WriteCalibration(file_, config_.sensors, calibration);
  EXPECT_EQ(ReadCalibration(file_, config_.sensors), calibration);
}

TEST_F(CalibrationFileTest, NoFileIsNoCalibration) {
  EXPECT_EQ(ReadCalibration(file_, config_.sensors), std::nullopt);
}

TEST_F(CalibrationFileTest, ReplacesAFileInOneStepAndLeavesNothingElse) {
  WriteCalibration(file_, config_.sensors, {});
  WriteCalibration(file_, config_.sensors, {});
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) files += entry.exists();
  EXPECT_EQ(files, 1);
}

TEST_F(CalibrationFileTest, OtherSensorsAreRefused) {
  WriteCalibration(file_, config_.sensors, {});
  SensorConfig other = config_.sensors;
  other.strain[3].face = -1;
  EXPECT_THAT(MessageOf<InputError>([&] { ReadCalibration(file_, other); }),
              HasSubstr("made for other sensors"));
}

TEST_F(CalibrationFileTest, TextThatIsNoCalibrationIsRefusedWithTheFilesName) {
  for (const char* text : {"[1, 2]", R"({"encoder": 1, "strain": []})"}) {
    Put(text);
    EXPECT_THAT(Refusal(), HasSubstr("calibration.json: expected a calibration")) << text;
  }
  for (const char* text : {"", "{"}) {
    Put(text);
    EXPECT_THAT(Refusal(), HasSubstr("calibration.json:1: is not JSON; expected a calibration"))
        << text;
  }
}

// Both ended the daemon at its start: one without a word, one with the JSON library's.
TEST_F(CalibrationFileTest, NestedTextAndRowsOfNumbersAreRefused) {
  Put(std::string(40'000, '['));
  EXPECT_THAT(Refusal(), HasSubstr("calibration.json:1: is nested more than 32 levels deep"));
  Put(R"({"encoder": [1, 2], "strain": [3]})");
  EXPECT_THAT(Refusal(), HasSubstr("calibration.json: 'encoder': found a row that is no"));
}

// A gain error of -2 turned the feedback of the strains round: the arm tripped at 20 rad/s.
TEST_F(CalibrationFileTest, ValuesThatNoCommandCouldWriteAreRefusedByTheirName) {
  const auto refusal = [this](const char* list, const char* key, double value) {
    std::filesystem::remove_all(folder_);
    WriteCalibration(file_, config_.sensors, {});
    std::ifstream stream(file_);
    auto json = nlohmann::ordered_json::parse(stream);
    json[list][0][key] = value;
    Put(json.dump());
    return Refusal();
  };
  for (const double gain : {-2.0, 1e30, 0.31, -0.31}) {
    EXPECT_THAT(refusal("strain", "gain_error", gain),
                HasSubstr("calibration.json: strain_1_01: gain_error = "));
  }
  EXPECT_EQ(refusal("strain", "gain_error", 0.3), "");
  EXPECT_EQ(refusal("strain", "gain_error", -0.3), "");
  const double most = 0.25 * config_.sensors.strain_input.highest_count();
  EXPECT_EQ(refusal("strain", "zero_counts", most), "");
  EXPECT_THAT(refusal("strain", "zero_counts", -most - 1.0), HasSubstr("zero_counts"));
  EXPECT_THAT(refusal("encoder", "zero_counts", 1.5), HasSubstr("expected a whole number"));
}

TEST_F(CalibrationFileTest, ACounterZeroFarBeyondItsRangeIsNeitherReadNorWritten) {
  Calibration calibration{};
  calibration.counter_zero[0] = std::int64_t{1} << 60;
  EXPECT_THAT(MessageOf<InputError>([&] { WriteCalibration(file_, config_.sensors, calibration); }),
              HasSubstr("hub1: zero_counts = 1.15292e+18, expected "));
  EXPECT_FALSE(std::filesystem::exists(file_));
  Put(CalibrationText(config_.sensors, calibration));
  EXPECT_THAT(Refusal(), HasSubstr("hub1: zero_counts"));
}

TEST_F(CalibrationFileTest, TheNineBeforeThePresentOneAreKept) {
  const auto with = [](std::int64_t zero) {
    Calibration calibration{};
    calibration.counter_zero[0] = zero;
    return calibration;
  };
  for (std::int64_t i = 0; i <= 10; ++i) {
    WriteCalibration(file_, config_.sensors, with(i));
    WriteCalibration(file_, config_.sensors, with(i));  // the same again is no new one
  }
  EXPECT_EQ(ReadCalibration(file_, config_.sensors), with(10));
  for (int age = 1; age <= 9; ++age) {
    EXPECT_EQ(ReadCalibration(file_.string() + "." + std::to_string(age), config_.sensors),
              with(10 - age));
  }
  EXPECT_FALSE(std::filesystem::exists(file_.string() + ".10"));
}

TEST_F(CalibrationFileTest, AFileThatIsNoCalibrationIsNotReplaced) {
  Put("the only copy");
  EXPECT_THAT(MessageOf<InputError>([&] { WriteCalibration(file_, config_.sensors, {}); }),
              HasSubstr("exists and is not a calibration that flexarm wrote"));
}

TEST_F(CalibrationFileTest, AValueThatIsNoNumberIsNamed) {
  WriteCalibration(file_, config_.sensors, {});
  std::ifstream stream(file_);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  text.replace(text.find("\"gain_error\": 0.0"), 17, "\"gain_error\": null");
  Put(text);
  EXPECT_THAT(
      Refusal(),
      HasSubstr("calibration.json: strain[0]: 'gain_error': found null, expected a number"));
}

TEST_F(CalibrationFileTest, AFolderThatCannotBeMadeIsNamed) {
  Put("a file");
  EXPECT_THAT(MessageOf<InputError>(
                  [&] { WriteCalibration(file_ / "below" / "x.json", config_.sensors, {}); }),
              HasSubstr("cannot be made a folder"));
}

}  // namespace
}  // namespace flexarm
