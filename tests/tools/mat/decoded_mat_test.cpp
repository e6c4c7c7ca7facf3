// MAT files of decoded samples: libmatio reads back what the samples were.

#include "tools/mat/decoded_mat.h"

#include <gmock/gmock.h>
#include <matio.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace flexarm {
namespace {

using Variable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

DecodedRun TwoGauges() {
  DecodedRun run{};
  for (const int link : {1, 2}) {
    run.sensors.strain.push_back(
        {.link = link, .position_m = 0.1, .face = 1, .gain_v_per_unit = 5000, .offset_counts = 0});
  }
  run.sensors.strain_input = {.converter_bits = 12,
                              .range_v = 10.24,
                              .filter_hz = 0.0,
                              .noise_counts = 0.0,
                              .filter_damping = 0.0};  // 1 microstrain a count
  run.tip = {.layout = kR12,
             .length_m = {0.4, 0.3},
             .tip_slope_per_m = {2.0, -5.0},
             .settled_within_m = 0.007};
  run.with_raw = true;
  return run;
}

TickRecord Sample(int tick) {
  TickRecord record{};
  record.input.tick = record.output.tick = tick;
  record.input.sampling_instant_ns = 20'000'000 * std::int64_t{tick};
  record.input.safety_state = tick < 2 ? SafetyState::kArmed : SafetyState::kRunning;
  record.input.applied_torque_nm = {0.125 * tick, -1e-300};
  record.input.frame.strain[1] = 100 - tick;
  record.output.payload_kg = std::nan("");
  return record;
}

class DecodedMatTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    file_ = testing::TempDir() + info->name() + ".mat";
  }
  void TearDown() override {
    if (mat_ != nullptr) Mat_Close(mat_);
    std::remove(file_.c_str());
  }
  void Open(const std::string& bytes) {
    std::ofstream(file_, std::ios::binary) << bytes;
    mat_ = Mat_Open(file_.c_str(), MAT_ACC_RDONLY);
    ASSERT_NE(mat_, nullptr);
  }
  Variable Read(const char* name) {
    Variable variable(Mat_VarRead(mat_, name), Mat_VarFree);
    EXPECT_NE(variable, nullptr) << name;
    return variable;
  }
  std::vector<double> Numbers(const char* name) {
    const Variable variable = Read(name);
    if (!variable || variable->class_type != MAT_C_DOUBLE) return {};
    EXPECT_EQ(variable->dims[1], 1U);
    const auto* data = static_cast<const double*>(variable->data);
    return {data, data + variable->dims[0]};
  }
  // Row `row` of a matrix of characters.
  static std::string Line(const matvar_t& variable, std::size_t row) {
    std::string text;
    const auto* data = static_cast<const char*>(variable.data);
    for (std::size_t j = 0; j < variable.dims[1]; ++j) text += data[j * variable.dims[0] + row];
    return text;
  }

  std::string file_;
  mat_t* mat_ = nullptr;
};

TEST_F(DecodedMatTest, EveryColumnIsAVariableWithItsValues) {
  DecodedMat written(TwoGauges());
  for (int tick = 0; tick < 3; ++tick) {
    const TickRecord record = Sample(tick);
    written.Row({record, nullptr});
  }
  const std::string bytes = written.Bytes();
  EXPECT_TRUE(bytes.starts_with(kDecodedMatMark));
  EXPECT_EQ(bytes, written.Bytes());  // no date in it
  Open(bytes);
  EXPECT_EQ(Numbers("tick"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(Numbers("time_s"), (std::vector<double>{0, 0.02, 0.04}));
  EXPECT_EQ(Numbers("torque_applied_1_nm"), (std::vector<double>{0, 0.125, 0.25}));
  EXPECT_EQ(Numbers("torque_applied_2_nm"), (std::vector<double>(3, -1e-300)));
  EXPECT_THAT(Numbers("strain_2_01_microstrain"),
              testing::Pointwise(testing::DoubleNear(1e-9), {100.0, 99.0, 98.0}));
  EXPECT_EQ(Numbers("strain_2_01"), (std::vector<double>{100, 99, 98}));
  EXPECT_TRUE(std::isnan(Numbers("payload_kg").at(1)));
  const Variable state = Read("state");
  ASSERT_EQ(state->class_type, MAT_C_CHAR);
  EXPECT_EQ(Line(*state, 0), "Armed  ");
  EXPECT_EQ(Line(*state, 2), "Running");
}

TEST_F(DecodedMatTest, UnitsHasAFieldForEveryVariable) {
  DecodedMat written(TwoGauges());
  const TickRecord record = Sample(0);
  written.Row({record, nullptr});
  Open(written.Bytes());
  const Variable units = Read("units");
  ASSERT_EQ(units->class_type, MAT_C_STRUCT);
  int columns = 0;
  for (const DecodedColumn& column : DecodedColumns(TwoGauges())) {
    const matvar_t* unit = Mat_VarGetStructFieldByName(units.get(), column.name.c_str(), 0);
    ASSERT_NE(unit, nullptr) << column.name;
    EXPECT_EQ(Line(*unit, 0), column.unit) << column.name;
    Read(column.name.c_str());
    EXPECT_LE(column.name.size(), 63U);  // MATLAB's names are no longer
    ++columns;
  }
  EXPECT_GT(columns, 40);
}

TEST_F(DecodedMatTest, ARunWithoutSamplesIsAFileWithEmptyColumns) {
  Open(DecodedMat(TwoGauges()).Bytes());
  EXPECT_TRUE(Numbers("hub_1_deg").empty());
}

}  // namespace
}  // namespace flexarm
