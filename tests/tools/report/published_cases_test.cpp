#include "config/published_cases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "config/config.h"
#include "tools/report/published_results.h"

namespace flexarm {
namespace {

std::filesystem::path PublishedFolder() {
  return std::filesystem::path(FLEXARM_SOURCE_DIR) / "config" / "published";
}

// Each tolerance stands beside its figure in config/published/cases.toml, with its reason.
TEST(PublishedCases, FiguresOfTheLiteratureAreComputedWithinTheirTolerances) {
  for (const PublishedComparison& comparison : ComparePublished(PublishedFolder() / "cases.toml")) {
    EXPECT_FALSE(comparison.result.empty()) << comparison.of.name;
    for (const PublishedResult& result : comparison.result) {
      EXPECT_TRUE(result.as_expected())
          << comparison.of.name << ", " << result.figure.symbol << ", " << LabelOf(result.figure)
          << ": published " << result.figure.published << ", computed " << result.computed;
    }
  }
}

TEST(PublishedCases, ThereAreThreeWithTwoLinksAndOneWithOne) {
  int two = 0, one = 0;
  for (const PublishedCase& of : LoadPublishedCases(PublishedFolder() / "cases.toml")) {
    ++(of.links == 2 ? two : one);
    for (const std::string& text :
         {of.author, of.title, of.place, of.table, of.read_in, of.obtained, of.tolerance_reason}) {
      EXPECT_FALSE(text.empty()) << of.name;
    }
  }
  EXPECT_GE(two, 3);
  EXPECT_GE(one, 1);
}

TEST(PublishedCases, EveryArmIsAConfigThatLoads) {
  for (const auto& entry : std::filesystem::directory_iterator(PublishedFolder())) {
    if (entry.path().filename() == "cases.toml") continue;
    EXPECT_NO_THROW(LoadConfig(entry.path())) << entry.path();
  }
}

TEST(PublishedCases, QuantityThatThePartDoesNotHaveIsRefusedWithItsLine) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "published-broken.toml";
  std::ofstream(file) << "[[case]]\nname = \"n\"\nconfig = \"c\"\nlinks = 1\nauthor = \"a\"\n"
                         "title = \"t\"\nyear = 1\nplace = \"p\"\ntable = \"t\"\nread_in = \"r\"\n"
                         "obtained = \"o\"\ntolerance_reason = \"r\"\n[[case.figure]]\n"
                         "symbol = \"b\"\nof = \"arm\"\nquantity = \"beta_l\"\nmode = 1\n"
                         "published = 1.0\ntolerance = 0.1\n";
  try {
    LoadPublishedCases(file);
    ADD_FAILURE() << "was accepted";
  } catch (const ConfigError& error) {
    ASSERT_EQ(error.problems().size(), 1U) << error.what();
    EXPECT_EQ(error.problems()[0].key, "case[0].figure[0].quantity");
    EXPECT_EQ(error.problems()[0].line, 16);
  }
}

}  // namespace
}  // namespace flexarm
