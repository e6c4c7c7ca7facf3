#include "controller/commissioning/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

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
  calibration.counter_zero = {1, -2, 3'000'000'000, 4};
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
  for (const char* text : {"", "{", "[1, 2]", R"({"encoder": 1, "strain": []})"}) {
    Put(text);
    EXPECT_THAT(Refusal(), HasSubstr("calibration.json: expected a calibration")) << text;
  }
}

TEST_F(CalibrationFileTest, AValueThatIsNoNumberIsNamed) {
  WriteCalibration(file_, config_.sensors, {});
  std::ifstream stream(file_);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  text.replace(text.find("\"gain_error\": 0.0"), 17, "\"gain_error\": null");
  Put(text);
  EXPECT_THAT(Refusal(), HasSubstr("expected a number in 'gain_error'"));
}

TEST_F(CalibrationFileTest, AFolderThatCannotBeMadeIsNamed) {
  Put("a file");
  EXPECT_THAT(MessageOf<InputError>(
                  [&] { WriteCalibration(file_ / "below" / "x.json", config_.sensors, {}); }),
              HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace flexarm
