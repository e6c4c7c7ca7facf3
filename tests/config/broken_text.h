#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "config/config.h"
#include "tests/config/config_testing.h"

namespace flexarm {

/// One edit of a file's text that causes one problem.
struct BrokenText {
  std::string name;
  std::string from;  ///< its first occurrence in the text is replaced ...
  std::string to;    ///< ... by this
  std::string key;   ///< the key that is reported
  std::string rule;  ///< a part of the message
  /// The text whose line is reported; the last line of `to` if not given.
  std::string line_of = {};
  std::string text = {};  ///< for suites with several texts

  std::string Edit(const std::string& whole) const { return Replaced(whole, from, to); }
};

inline void PrintTo(const BrokenText& c, std::ostream* out) { *out << c.name; }

inline std::string NameOfCase(const ::testing::TestParamInfo<BrokenText>& info) {
  return info.param.name;
}

/// Expects that the edited `text` of `file` has exactly one problem, the one of the case.
inline void ExpectReportedOnce(const BrokenText& c, const std::string& text,
                               const std::string& file,
                               const std::vector<ConfigProblem>& problems) {
  ASSERT_FALSE(problems.empty()) << "was accepted";
  for (std::size_t i = 1; i < problems.size(); ++i) ADD_FAILURE() << problems[i].Text();
  EXPECT_EQ(problems[0].file, file);
  EXPECT_EQ(problems[0].line, LineOf(text, c.line_of.empty() ? c.to : c.line_of));
  EXPECT_EQ(problems[0].key, c.key);
  EXPECT_THAT(problems[0].rule, ::testing::HasSubstr(c.rule));
}

/// Edits of thesis-rig.toml: one test (broken_config_test.cpp) with the tables of several files.
class BrokenConfig : public ::testing::TestWithParam<BrokenText> {};

}  // namespace flexarm
