#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "config/config.h"
#include "config/derivation/derivation.h"
#include "config/shown_config.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

std::string Without(std::string text, const std::string& line) {
  const std::size_t begin = text.find(line);
  EXPECT_NE(begin, std::string::npos) << line;
  return text.erase(begin, text.find('\n', begin) + 1 - begin);
}

std::string ThesisText() { return FileText(Shipped("thesis-rig.toml")); }

TEST(DerivedKeys, FollowTheArmWhenTheyAreLeftOut) {
  const std::string text = Without(ThesisText(), "slew_limit_nm_per_s");
  const RigConfig config = ParseConfig(text, "rig.toml");
  EXPECT_EQ(config.safety.slew_limit_nm_per_s, (std::array{600.0, 120.0}));
  const RigConfig slower = WithOverrides(ParseConfig(text, "rig.toml"), {});
  EXPECT_EQ(slower.safety.slew_limit_nm_per_s, config.safety.slew_limit_nm_per_s)
      << "a log's config is complete";
}

TEST(DerivedKeys, DoNotReplaceWhatTheFileSays) {
  EXPECT_EQ(ParseConfig(ThesisText(), "rig.toml").safety.slew_limit_nm_per_s,
            (std::array{500.0, 150.0}));
}

TEST(DerivedKeys, AreNotMissedWhereWhatTheyDependOnIsWrong) {
  const std::string text = Without(Without(ThesisText(), "slew_limit_nm_per_s"), "period_ms");
  try {
    ParseConfig(text, "rig.toml");
    FAIL() << "was accepted";
  } catch (const ConfigError& error) {
    ASSERT_EQ(error.problems().size(), 1U) << error.what();
    EXPECT_EQ(error.problems()[0].key, "loop.period_ms");
  }
}

TEST(ShownConfig, NamesTheSourceOfEachValue) {
  const TempFolder folder;
  const std::filesystem::path file =
      folder.Write("shown.toml", "extends = \"" + Shipped("thesis-rig.toml").string() +
                                     "\"\n[limits]\ntorque_limit_nm = [20.0, 5.0]\n");
  int derived = 0;
  std::map<std::string, ShownValue> by_key;
  for (const ShownValue& shown : ShownConfig(file, {"controller.alpha=2"})) {
    by_key[shown.key] = shown;
    derived += shown.file.empty() ? 1 : 0;
  }
  EXPECT_EQ(derived, 0) << "the shipped rig states every key";
  EXPECT_EQ(by_key.at("controller.alpha").origin, "--set");
  EXPECT_EQ(by_key.at("limits.torque_limit_nm").value, "[20.0, 5.0]");
  EXPECT_THAT(by_key.at("limits.torque_limit_nm").origin, HasSubstr("shown.toml:3"));
  EXPECT_THAT(by_key.at("loop.period_ms").origin, HasSubstr("thesis-rig.toml:"));
  EXPECT_EQ(by_key.at("sensors.strain[19].position_m").value, "0.855");
}

TEST(ShownConfig, SaysHowAValueWasDerived) {
  const TempFolder folder;
  const std::filesystem::path file =
      folder.Write("derived.toml", Without(ThesisText(), "slew_limit_nm_per_s"));
  for (const ShownValue& shown : ShownConfig(file, {})) {
    if (shown.key != "limits.slew_limit_nm_per_s") continue;
    EXPECT_EQ(shown.value, "[600.0, 120.0]");
    EXPECT_EQ(shown.origin, "derived: the torque limit in two and a half periods");
    return;
  }
  FAIL() << "is not shown";
}

}  // namespace
}  // namespace flexarm
