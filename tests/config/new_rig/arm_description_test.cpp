#include "config/new_rig/arm_description.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/config/config_testing.h"
#include "tests/config/new_rig/steel_arm.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(ArmDescription, IsReadFromAFile) {
  const TempFolder folder;
  const ArmDescriptionReader reader(folder.Write("arm.toml", kSteelArm));
  EXPECT_THAT(reader.Missing(), IsEmpty());
  const ArmDescription arm = reader.Read();
  EXPECT_EQ(arm.name, "new-rig");
  EXPECT_STREQ(arm.material[1].name, "steel");
  EXPECT_EQ(arm.At("link2.thickness_mm"), 2.0);
  EXPECT_EQ(arm.At("joint2.torque_limit_nm"), 3.0);
  EXPECT_FALSE(arm.Has("payload_max_kg"));
}

TEST(ArmDescription, NeedsAtMostFifteenAnswers) {
  EXPECT_LE(ArmDescriptionReader("").Missing().size(), 15U);
}

TEST(ArmDescription, IsCompleteWithWhatItMisses) {
  ArmDescriptionReader reader("");
  for (const std::string& key : reader.Missing()) {
    reader.Set(key, key == "material" ? "aluminium" : key.ends_with("per_turn") ? "2000" : "10");
  }
  EXPECT_THAT(reader.Missing(), IsEmpty());
  for (const char* length : {"link1.length_m", "link2.length_m"}) reader.Set(length, "1");
  EXPECT_EQ(reader.Read().At("rate_hz"), 10.0);
}

TEST(ArmDescription, HasTheLastValueOfAKey) {
  const TempFolder folder;
  ArmDescriptionReader reader(folder.Write("arm.toml", kSteelArm), {"rate_hz=100"});
  reader.Set("link1.material", "titanium");
  const ArmDescription arm = reader.Read();
  EXPECT_EQ(arm.At("rate_hz"), 100.0);
  EXPECT_STREQ(arm.material[0].name, "titanium");
  EXPECT_STREQ(arm.material[1].name, "steel");
}

TEST(ArmDescription, ReportsEveryProblemWithItsPlace) {
  const TempFolder folder;
  const auto file =
      folder.Write("arm.toml", Replaced(Replaced(kSteelArm, "tip_mass_kg = 0.3\n", ""),
                                        "rate_hz = 50", "rate_hz = 5000\nlenght_m = 1"));
  const std::vector<ConfigProblem> problems =
      ProblemsFrom([&] { ArmDescriptionReader(file, {"material=wood"}).Read(); });
  ASSERT_EQ(problems.size(), 4U);
  const auto rule = [&](const char* key) {
    const auto found = std::find_if(problems.begin(), problems.end(),
                                    [key](const ConfigProblem& p) { return p.key == key; });
    return found == problems.end() ? std::string("no problem") : found->Text();
  };
  EXPECT_THAT(rule("tip_mass_kg"), HasSubstr("missing"));
  EXPECT_THAT(rule("rate_hz"), HasSubstr("arm.toml:8: rate_hz = 5000: must lie in 10 .. 500"));
  EXPECT_THAT(rule("lenght_m"), HasSubstr("unknown key"));
  EXPECT_THAT(rule("material"), HasSubstr("must be one of \"aluminium\" \"steel\""));
}

TEST(ArmDescription, EveryKeyIsInRangeOfItsOwnQuestion) {
  for (const ArmKey& key : ArmKeys()) {
    EXPECT_LT(key.least, key.most) << key.key;
    EXPECT_EQ(std::string(key.otherwise).empty(), key.required) << key.key;
  }
}

}  // namespace
}  // namespace flexarm
