#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "config/config.h"
#include "tests/config/config_testing.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;

std::string ErrorOf(const std::filesystem::path& file) {
  return MessageOf<ConfigError>([&] { LoadConfig(file); });
}

TEST(Extends, ChainsAcrossFoldersRelativeToEachFile) {
  const TempFolder folder;
  folder.Write("base/rig.toml", FileText(Shipped("thesis-rig.toml")));
  folder.Write("base/middle.toml",
               "extends = \"rig.toml\"\n[controller]\nalpha = 2.0\nsigma = 0.5\n");
  const auto top = folder.Write("top.toml",
                                "extends = \"base/middle.toml\"\n[controller]\nalpha = 1.0\n"
                                "[limits]\nsoft_angle_deg = [80, 85]\n");
  const RigConfig config = LoadConfig(top);
  EXPECT_EQ(config.controller.alpha, 1.0);
  EXPECT_EQ(config.controller.sigma, 0.5);
  EXPECT_EQ(config.controller.vartheta, 0.35);
  EXPECT_EQ(config.safety.soft_angle_deg, (std::array{80.0, 85.0}));
  EXPECT_THAT(config.text, ::testing::Not(HasSubstr("extends")));
}

TEST(Extends, ReplacesRowsAsAWhole) {
  const TempFolder folder;
  folder.Write("rig.toml", FileText(Shipped("thesis-rig.toml")));
  const auto top = folder.Write("top.toml",
                                "extends = \"rig.toml\"\n[[sensors.encoder]]\njoint = \"hub1\"\n"
                                "counts_per_turn = 2540\ncounter_bits = 8\nsign = 1\n");
  EXPECT_THAT(ErrorOf(top), HasSubstr("sensors.encoder = 1 rows: must have a row with joint = "
                                      "\"hub2\""));
}

TEST(Extends, ProblemsNameTheFileInWhichTheValueStands) {
  const TempFolder folder;
  const std::string rig =
      Replaced(FileText(Shipped("thesis-rig.toml")), "vartheta = 0.35", "vartheta = 35");
  const auto base = folder.Write("rig.toml", rig);
  const auto top = folder.Write("top.toml", "extends = \"rig.toml\"\n\n[controller]\nalpha = 11\n");
  const std::vector<ConfigProblem> problems = ProblemsFrom([&] { LoadConfig(top); });
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].file, base.string());
  EXPECT_EQ(problems[0].line, LineOf(rig, "vartheta = 35"));
  EXPECT_EQ(problems[0].key, "controller.vartheta");
  EXPECT_EQ(problems[1].file, top.string());
  EXPECT_EQ(problems[1].line, 4);
  EXPECT_EQ(problems[1].key, "controller.alpha");
}

TEST(Extends, RefusesACycle) {
  const TempFolder folder;
  folder.Write("a.toml", "extends = \"b.toml\"\n");
  folder.Write("b.toml", "extends = \"c.toml\"\n");
  const auto c = folder.Write("c.toml", "\n\nextends = \"./a.toml\"\n");
  EXPECT_THAT(ErrorOf(folder.path() / "a.toml"),
              HasSubstr(c.string() + ":3: extends = \"./a.toml\": must not lead back"));
}

TEST(Extends, RefusesItself) {
  const TempFolder folder;
  const auto file = folder.Write("a.toml", "extends = \"a.toml\"\n");
  EXPECT_THAT(ErrorOf(file), HasSubstr(":1: extends"));
}

TEST(Extends, NamesTheLineOfAMissingFile) {
  const TempFolder folder;
  const auto file = folder.Write("a.toml", "# a\nextends = \"none.toml\"\n");
  EXPECT_THAT(ErrorOf(file), HasSubstr(file.string() + ":2: extends = \"none.toml\": there is no "
                                                       "file"));
  EXPECT_THAT(ErrorOf(folder.Write("b.toml", "extends = 3\n")), HasSubstr("as a string"));
}

TEST(Extends, ReportsABrokenBaseUnderItsOwnName) {
  const TempFolder folder;
  const auto base = folder.Write("base.toml", "[rig]\nname =\n");
  const auto top = folder.Write("top.toml", "extends = \"base.toml\"\n");
  EXPECT_THAT(ErrorOf(top), HasSubstr(base.string() + ":2: is not valid TOML"));
}

TEST(ConfigFile, GetsOneMessageIfItIsNotAConfig) {
  const TempFolder folder;
  const auto expect = [](const std::filesystem::path& file, const std::string& rule) {
    const std::string error = ErrorOf(file);
    EXPECT_EQ(error.rfind(file.string(), 0), 0U) << error;
    EXPECT_THAT(error, HasSubstr(rule));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  };
  expect(folder.path() / "none.toml", "cannot be read: No such file or directory");
  expect(folder.path(), "is a directory");
  expect(folder.Write("empty.toml", ""), "is empty");
  expect(folder.Write("blank.toml", "\n \n"), "is empty");
  expect(folder.Write("huge.toml", std::string((1 << 20) + 1, '#')), "larger than 1 MiB");
  expect(folder.Write("latin1.toml", "[rig]\nname = \"b\xe4r\"\n"), ":2: found the byte");
  expect(folder.Write("zero.toml", std::string("[rig]\0", 6)), ":1: found the control character");
  expect("/dev/zero", "is a device; expected a TOML file");
}

TEST(ConfigFile, MayStartWithAByteOrderMarkAndHoldUmlauts) {
  const TempFolder folder;
  const std::string text = "\xef\xbb\xbf" + Replaced(FileText(Shipped("thesis-rig.toml")),
                                                     "\"thesis-rig\"", "\"B\xc3\xa4r\"");
  EXPECT_EQ(LoadConfig(folder.Write("rig.toml", text)).rig_name, "B\xc3\xa4r");
}

}  // namespace
}  // namespace flexarm
