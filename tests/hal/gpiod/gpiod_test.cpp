#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "hal/bus_device.h"
#include "hal/gpiod/gpiod_config.h"
#include "hal/gpiod/gpiod_lines.h"

// Tests without a GPIO chip; the lines themselves are tested with gpio-sim in tests/guest.

namespace flexarm {
namespace {

GpiodConfig Good() {
  return {.chip = "/dev/gpiochip0", .input = {0, 1, 2, 3, 4, 5}, .relay = 6, .pump = 7};
}

std::string KeysOf(const GpiodConfig& config) {
  std::string keys;
  for (const Problem& problem : config.Problems()) keys += problem.key + " ";
  return keys;
}

TEST(GpiodConfig, DistinctLinesAreAccepted) { EXPECT_EQ(KeysOf(Good()), ""); }

TEST(GpiodConfig, TwoUsesOfOneLineAreRejectedByBothNames) {
  GpiodConfig config = Good();
  config.pump = config.input[4];
  ASSERT_EQ(config.Problems().size(), 1u);
  EXPECT_EQ(config.Problems()[0].key, "hal.gpiod.pump");
  EXPECT_THAT(config.Problems()[0].rule, testing::HasSubstr("emergency_stop uses it"));
}

TEST(GpiodConfig, OffsetsAndChipAreChecked) {
  GpiodConfig config = Good();
  config.chip = "";
  config.input[0] = -1;
  config.relay = 5000;
  EXPECT_EQ(KeysOf(config), "hal.gpiod.chip hal.gpiod.limit_1_low hal.gpiod.relay ");
}

TEST(GpiodLines, AMissingChipIsNamed) {
  GpiodConfig config = Good();
  config.chip = "no-such-chip";
  try {
    const GpiodLines lines(config);
    FAIL() << "opened a chip that does not exist";
  } catch (const HalError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("gpiod no-such-chip: cannot be opened"));
  }
}

}  // namespace
}  // namespace flexarm
