#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>

#include "config/config.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

TEST(ConfigText, OfEveryShippedRigReadsBackToTheSameText) {
  for (const char* name :
       {"thesis-rig.toml", "thesis-rig-printed.toml", "thesis-rig-stiffened.toml", "hil.toml"}) {
    const std::string text = LoadConfig(Shipped(name)).text;
    EXPECT_EQ(ParseConfig(text, "log").text, text);
  }
}

TEST(ConfigText, KeepsEveryBitOfANumber) {
  std::mt19937_64 bits(20261120);
  const RigConfig rig = LoadConfig(Shipped("hil.toml"));
  for (int i = 0; i < 300; ++i) {
    const double number = std::abs(std::bit_cast<double>(bits()));
    if (!std::isfinite(number)) continue;
    std::array<char, 40> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number,
                                   std::chars_format::scientific, 16);
    const std::string value(digits.data(), end.ptr);
    const RigConfig config = LoadConfig(Shipped("hil.toml"), {"arm.payload_mass_kg=" + value});
    const double back = ParseConfig(config.text, "log").arm.payload_mass_kg;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(config.arm.payload_mass_kg),
              std::bit_cast<std::uint64_t>(number))
        << value;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(number)) << value;
  }
}

TEST(ConfigText, KeepsMinusZeroAndWholeNumbers) {
  const RigConfig config = LoadConfig(Shipped("hil.toml"), {"sensors.strain[0].offset_counts=-0.0",
                                                            "sensors.strain[1].offset_counts=3"});
  const RigConfig back = ParseConfig(config.text, "log");
  EXPECT_TRUE(std::signbit(back.sensors.strain[0].offset_counts));
  EXPECT_EQ(back.sensors.strain[1].offset_counts, 3.0);
  EXPECT_EQ(back.text, config.text);
}

TEST(ConfigText, KeepsTheLargestSeed) {
  const RigConfig config = LoadConfig(Shipped("hil.toml"), {"sim.seed=9223372036854775807"});
  EXPECT_EQ(ParseConfig(config.text, "log").sim.seed, 9223372036854775807U);
}

TEST(ConfigText, KeepsEveryCharacterOfAString) {
  const std::string name = "\"quotes\" 'and' \\ tab\t line\n bell\a del\x7f B\xc3\xa4r";
  const RigConfig config = LoadConfig(
      Shipped("hil.toml"), {R"(rig.name="\"quotes\" 'and' \\ tab\t line\n bell\u0007 del\u007f B)"
                            "\xc3\xa4r\""});
  EXPECT_EQ(config.rig_name, name);
  EXPECT_EQ(ParseConfig(config.text, "log").rig_name, name);
}

TEST(ConfigText, DoesNotDependOnTheWayTheFileIsWritten) {
  const TempFolder folder;
  const std::string rig = FileText(Shipped("thesis-rig.toml"));
  const auto other = folder.Write(
      "rig.toml", Replaced(rig, "[daemon]\nsocket = \"/run/flexarm/flexarmd.sock\"",
                           "[daemon] # a comment\n  socket='/run/flexarm/flexarmd.sock'"));
  EXPECT_EQ(LoadConfig(other).text, LoadConfig(Shipped("thesis-rig.toml")).text);
}

}  // namespace
}  // namespace flexarm
