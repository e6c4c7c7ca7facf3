#include "controller/files/nesting.h"

#include <gtest/gtest.h>

#include <string>

namespace flexarm {
namespace {

std::string Times(const std::string& part, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += part;
  return text;
}

TEST(Nesting, JsonIsCountedByItsBrackets) {
  EXPECT_EQ(LineNestedTooDeepJson(Times("[", 32) + Times("]", 32)), 0);
  EXPECT_EQ(LineNestedTooDeepJson(std::string("\n\n") + Times("[", 33)), 3);
  EXPECT_EQ(LineNestedTooDeepJson(Times("{\"a\":", 33)), 1);
  EXPECT_EQ(LineNestedTooDeepJson(std::string("[") + Times("[],", 1000) + "0]"), 0)
      << "one beside the other";
}

TEST(Nesting, BracketsInJsonStringsDoNotCount) {
  EXPECT_EQ(LineNestedTooDeepJson(std::string("\"") + Times("[", 100) + "\""), 0);
  EXPECT_EQ(LineNestedTooDeepJson(std::string("\"\\\"") + Times("[", 100) + "\""), 0);
  EXPECT_EQ(LineNestedTooDeepJson(std::string("\"\\\\\"") + Times("[", 100)), 1)
      << "the string has ended";
}

TEST(Nesting, TomlIsCountedByBracketsAndByThePartsOfKeys) {
  EXPECT_EQ(LineNestedTooDeepToml(std::string("a = ") + Times("[", 32)), 0);
  EXPECT_EQ(LineNestedTooDeepToml(std::string("\na = ") + Times("[", 33)), 2);
  EXPECT_EQ(LineNestedTooDeepToml(Times("a.", 32) + "a = 1"), 0);
  EXPECT_EQ(LineNestedTooDeepToml(Times("a.", 33) + "a = 1"), 1);
  EXPECT_EQ(LineNestedTooDeepToml(Times("\"a\" . ", 33) + "a = 1"), 1) << "quoted, with spaces";
  EXPECT_EQ(LineNestedTooDeepToml(std::string("[") + Times("a.", 33) + "a]"), 1);
  EXPECT_EQ(LineNestedTooDeepToml(std::string("x = {") + Times("a.", 33) + "a = 1}"), 1);
}

TEST(Nesting, DotsThatDoNotNestAreNotCounted) {
  EXPECT_EQ(LineNestedTooDeepToml(std::string("x = [") + Times("1.0, ", 100) + "]"), 0);
  EXPECT_EQ(LineNestedTooDeepToml(std::string("x = [\n") + Times("1.0,\n", 100) + "]"), 0);
  EXPECT_EQ(LineNestedTooDeepToml(std::string("x = 1 # ") + Times("[.", 100)), 0);
  EXPECT_EQ(LineNestedTooDeepToml(Times("a.b = 1.5\n", 100)), 0);
  EXPECT_EQ(LineNestedTooDeepToml(Times("a.b = 1.5\r", 20)), 0);
}

TEST(Nesting, TomlStringsOfAllFourKindsDoNotCount) {
  const std::string brackets = Times("[.", 100);
  EXPECT_EQ(LineNestedTooDeepToml("x = \"" + brackets + "\""), 0);
  EXPECT_EQ(LineNestedTooDeepToml("x = '" + brackets + "'"), 0);
  EXPECT_EQ(LineNestedTooDeepToml("x = \"\"\"\n" + brackets + "\"\n\"\"\""), 0);
  EXPECT_EQ(LineNestedTooDeepToml("x = '''\n" + brackets + "'\n'''"), 0);
  EXPECT_EQ(LineNestedTooDeepToml("x = '\\'\ny = " + brackets), 2) << "no escapes in literals";
  EXPECT_EQ(LineNestedTooDeepToml("x = \"open\ny = " + brackets), 2) << "ends with its line";
}

}  // namespace
}  // namespace flexarm
