#include "hal/modbus/modbus_value.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>

#include "tests/hal/modbus/modbus_testing.h"

// Register contents computed by hand, or from IEEE 754: 1.5f is 0x3FC00000.

namespace flexarm {
namespace {

using enum ModbusType;
using enum ModbusWordOrder;

std::optional<std::int32_t> Counts(ModbusType type, ModbusWordOrder order,
                                   std::array<std::uint16_t, 2> words, double scale = 1.0,
                                   double offset = 0.0) {
  ModbusRegister row = StrainRow(0, 0, type, order);
  row.scale = scale;
  row.offset_counts = offset;
  return CountsFromWords(row, words.data());
}

TEST(ModbusValue, ReadsEachTypeInBothWordOrders) {
  EXPECT_EQ(Counts(kInt16, kBig, {0xFFFE, 0}), -2);
  EXPECT_EQ(Counts(kUint16, kBig, {0xFFFE, 0}), 65534);
  EXPECT_EQ(Counts(kInt32, kBig, {0x0001, 0x0002}), 65538);
  EXPECT_EQ(Counts(kInt32, kLittle, {0x0001, 0x0002}), 131073);
  EXPECT_EQ(Counts(kInt32, kBig, {0xFFFF, 0xFFFE}), -2);
  EXPECT_EQ(Counts(kFloat32, kBig, {0x3FC0, 0x0000}, 100.0), 150);
  EXPECT_EQ(Counts(kFloat32, kLittle, {0x0000, 0x3FC0}, 100.0), 150);
}

TEST(ModbusValue, ScalesThenShiftsThenRounds) {
  EXPECT_EQ(Counts(kInt16, kBig, {1000, 0}, 0.25, -10.0), 240);
  EXPECT_EQ(Counts(kInt16, kBig, {1000, 0}, -0.25, -10.0), -260);
  EXPECT_EQ(Counts(kInt16, kBig, {1, 0}, 0.5, 0.0), 1);  // 0.5: halves go away from zero
  EXPECT_EQ(Counts(kInt16, kBig, {0xFFFF, 0}, 0.5, 0.0), -1);
}

TEST(ModbusValue, NanAndOverflowGiveNoReading) {
  EXPECT_EQ(Counts(kFloat32, kBig, {0x7FC0, 0x0000}), std::nullopt);  // NaN
  EXPECT_EQ(Counts(kFloat32, kBig, {0x7F80, 0x0000}), std::nullopt);  // infinity
  EXPECT_EQ(Counts(kFloat32, kBig, {0x4F00, 0x0000}), std::nullopt);  // 2^31: one too many
  EXPECT_EQ(Counts(kFloat32, kBig, {0xCF00, 0x0000}),
            std::numeric_limits<std::int32_t>::min());  // -2^31 just fits
  EXPECT_EQ(Counts(kInt32, kBig, {0x7FFF, 0xFFFF}, 1.0, 1.0), std::nullopt);
}

TEST(ModbusValue, WritesWhatItReads) {
  for (const ModbusType type : {kInt16, kUint16, kInt32, kFloat32}) {
    for (const ModbusWordOrder order : {kBig, kLittle}) {
      ModbusRegister row = StrainRow(0, 0, type, order);
      row.scale = 0.5;  // every count has an exact value
      row.offset_counts = -20.0;
      for (const std::int32_t counts : {-20, 0, 1, 12345}) {
        std::array<std::uint16_t, 2> words{};
        WordsFromCounts(row, counts, words.data());
        EXPECT_EQ(CountsFromWords(row, words.data()), counts) << static_cast<int>(type);
      }
    }
  }
}

TEST(ModbusValue, TheSimulatedAmplifierClips) {
  std::array<std::uint16_t, 2> words{};
  WordsFromCounts(StrainRow(0, 0, kInt16), 40000, words.data());
  EXPECT_EQ(words[0], 0x7FFF);
  WordsFromCounts(StrainRow(0, 0, kInt16), -40000, words.data());
  EXPECT_EQ(words[0], 0x8000);
  WordsFromCounts(StrainRow(0, 0, kUint16), -1, words.data());
  EXPECT_EQ(words[0], 0);
}

}  // namespace
}  // namespace flexarm
