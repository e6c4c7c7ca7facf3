#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/config.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;

std::vector<ConfigProblem> ProblemsWith(const std::vector<std::string>& overrides) {
  try {
    HilWith(overrides);
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(Overrides, SetNumbersWordsAndArrays) {
  const RigConfig config =
      HilWith({"controller.alpha=2", "controller.name=lqr-cgt", "controller.prediction=false",
               "limits.soft_angle_deg = [80, 85.5]", "daemon.socket=/tmp/a.sock",
               "rig.name=\"two words\"", "controller.gains=gains.json"});
  EXPECT_EQ(config.controller.alpha, 2.0);
  EXPECT_EQ(config.controller.kind, ControllerKind::kLqrCgt);
  EXPECT_FALSE(config.controller.prediction);
  EXPECT_EQ(config.safety.soft_angle_deg, (std::array{80.0, 85.5}));
  EXPECT_EQ(config.daemon.socket, "/tmp/a.sock");
  EXPECT_EQ(config.rig_name, "two words");
  EXPECT_EQ(config.controller.gains_file, "gains.json");
  EXPECT_EQ(config.controller.vartheta, 0.35);  // other values do not change
}

TEST(Overrides, ReachRowsAndElementsByNumber) {
  const RigConfig config = HilWith({"sensors.strain[3].face=-1", "limits.soft_angle_deg[1]=80",
                                    "link2.section[0].length_m=0.95"});
  EXPECT_EQ(config.sensors.strain[3].face, -1);
  EXPECT_EQ(config.sensors.strain[2].face, 1);
  EXPECT_EQ(config.sensors.strain.size(), 20U);
  EXPECT_EQ(config.safety.soft_angle_deg, (std::array{90.0, 80.0}));
  EXPECT_EQ(config.arm.link[1].section[0].length_m, 0.95);
}

TEST(Overrides, TheLastOneWins) {
  EXPECT_EQ(HilWith({"controller.alpha=1", "controller.alpha=2"}).controller.alpha, 2.0);
}

TEST(Overrides, AreInTheConfigText) {
  const RigConfig config = HilWith({"controller.alpha=2.5"});
  EXPECT_EQ(ParseConfig(config.text, "log").controller.alpha, 2.5);
  EXPECT_NE(config.text, HilWith({}).text);
}

TEST(Overrides, AreTheSourceOfTheirProblems) {
  const auto problems = ProblemsWith({"loop.period_ms=0"});
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].file, "--set");
  EXPECT_EQ(problems[0].line, 0);
  EXPECT_THAT(problems[0].Text(), HasSubstr("--set: loop.period_ms = 0: must lie in 1 .. 100"));
}

TEST(Overrides, OfAnElementKeepTheSourceOfTheOtherElements) {
  const auto problems = ProblemsWith({"sim.motor_lag_ms[1]=-1"});
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].file, "--set");
  EXPECT_EQ(problems[0].key, "sim.motor_lag_ms[1]");
}

TEST(Overrides, EachInvalidOneIsRefused) {
  const std::vector<std::string> bad = {
      "controller.alfa=1",            // unknown key
      "nothing.here=1",               // unknown section
      "alpha=1",                      // no section
      "controller.alpha",             // no value
      "=3",                           // no key
      "controller.alpha=",            // empty value
      "controller..alpha=1",          // empty name
      "rig.name=two words",           // not one word, not TOML
      "controller.alpha=1\nsigma=2",  // a second key in a second line
      "controller.alpha=1\ncontroller.sigma=0.1",
      "sensors.strain[20].face=1",   // no such row
      "sensors.strain[-1].face=1",   // no such row
      "sensors.strain[x].face=1",    //
      "controller.alpha[0]=1",       // no array
      "limits.soft_angle_deg[2]=1",  // no such element
      "controller.alpha=three",      // a word for a number
      "extends=other.toml",          // `extends` is allowed in files only
  };
  for (const std::string& text : bad) {
    const auto problems = ProblemsWith({text});
    ASSERT_EQ(problems.size(), 1U) << text;
    EXPECT_EQ(problems[0].file, "--set") << problems[0].Text();
  }
  EXPECT_EQ(ProblemsWith(bad).size(), bad.size());
}

}  // namespace
}  // namespace flexarm
