#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <string>

#include "config/config.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

// True if the text is a valid config; then its logged text must be valid too. Any exception other
// than ConfigError fails the test; the sanitizers detect memory errors.
bool Survives(const std::string& text) {
  try {
    const RigConfig config = ParseConfig(text, "fuzz");
    EXPECT_EQ(ParseConfig(config.text, "log").text, config.text);
    return true;
  } catch (const ConfigError& error) {
    EXPECT_FALSE(error.problems().empty());
    for (const ConfigProblem& p : error.problems()) {
      EXPECT_EQ(p.Text().find('\n'), std::string::npos) << p.Text();
    }
    return false;
  }
}

TEST(ConfigFuzz, ATextCutAnywhereIsRefusedOrComplete) {
  const std::string text = FileText(Shipped("thesis-rig.toml"));
  int whole = 0;
  for (std::size_t i = 0; i < 200; ++i) {
    if (Survives(text.substr(0, i * text.size() / 200))) ++whole;
  }
  EXPECT_EQ(whole, 0);  // the last section is required
  EXPECT_TRUE(Survives(text));
}

TEST(ConfigFuzz, FlippedBytesGiveAnErrorOrAConfig) {
  const std::string text = FileText(Shipped("thesis-rig.toml"));
  std::mt19937 random(1);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string flipped = text;
    const int flips = 1 + i % 3;
    for (int k = 0; k < flips; ++k) {
      const std::size_t at = random() % text.size();
      flipped[at] =
          static_cast<char>(static_cast<unsigned char>(flipped[at]) ^ (1U << random() % 8));
    }
    (Survives(flipped) ? accepted : refused) += 1;
  }
  EXPECT_GT(accepted, 0);  // flips in comments and in digits
  EXPECT_GT(refused, 0);
}

TEST(ConfigFuzz, FlippedExperimentsGiveAnErrorOrAnExperiment) {
  const std::string text = FileText(Shipped("experiments/sine.toml"));
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    std::string flipped = text;
    flipped[random() % text.size()] = static_cast<char>(random() % 256);
    try {
      ParseExperiment(flipped, "fuzz");
    } catch (const ConfigError& error) {
      EXPECT_FALSE(error.problems().empty());
    }
  }
}

std::string Repeated(const std::string& part, std::size_t times) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += part;
  return out;
}

TEST(ConfigFuzz, DeepNestingDoesNotExhaustTheStack) {
  const std::string dotted = Repeated("a.", 60'000) + "a";
  EXPECT_FALSE(Survives(dotted + " = 1\n"));
  EXPECT_FALSE(Survives("[" + dotted + "]\n"));
  EXPECT_FALSE(Survives("a = " + Repeated("[", 100'000)));
  EXPECT_FALSE(Survives(Repeated(Repeated("a.", 31) + "a = [{\n", 120) + "a = 1\n"));
  EXPECT_FALSE(Survives(Repeated("[a." + Repeated("b.", 30) + "c]\n", 2)));
}

TEST(ConfigFuzz, TheDeepestNestingThatIsReadIsReportedAsUnknown) {
  // 15 times a table in an array, with keys of two parts: brackets and dots of a key are 32.
  const std::string level = "a.a = [\n";
  const std::string text = level + Repeated("{" + level, 15) + Repeated("]}\n", 15) + "]\n";
  ASSERT_FALSE(ProblemsOf(text).empty());
  EXPECT_EQ(ProblemsOf(text).back().key, "a");
  const std::string deeper = level + Repeated("{" + level, 16) + Repeated("]}\n", 16) + "]\n";
  ASSERT_EQ(ProblemsOf(deeper).size(), 1U);
  EXPECT_NE(ProblemsOf(deeper).back().rule.find("nested more than 32 levels"), std::string::npos);
}

TEST(ConfigFuzz, DotsOfNumbersCommentsAndTextsDoNotNest) {
  EXPECT_EQ(ProblemsOf("x = [" + Repeated("1.0, ", 40) + "]\n").back().key, "x");
  EXPECT_EQ(ProblemsOf("# " + Repeated("[.", 40) + "\nx = 1\n").back().key, "x");
  EXPECT_EQ(ProblemsOf("x = '" + Repeated("[.", 40) + "'\n").back().key, "x");
  EXPECT_EQ(ProblemsOf("x = \"\"\"\n" + Repeated("[.\"\n", 40) + "\"\"\"\n").back().key, "x");
}

TEST(ConfigFuzz, ThousandsOfUnknownKeysAreReported) {
  std::string text = FileText(Shipped("thesis-rig.toml")) + "\n[unknown]\n[loop2]\n";
  std::string keys;
  for (int i = 0; i < 5000; ++i) keys += "key" + std::to_string(i) + " = 1\n";
  EXPECT_EQ(ProblemsOf(keys + text).size(), 5002U);
}

}  // namespace
}  // namespace flexarm
