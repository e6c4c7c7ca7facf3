#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "config/config.h"
#include "config/derivation/derivation.h"
#include "tests/config/broken_text.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;

TEST_P(BrokenConfig, IsReportedOnceWithLineKeyAndRule) {
  const std::string text = GetParam().Edit(FileText(Shipped("thesis-rig.toml")));
  ExpectReportedOnce(GetParam(), text, "rig.toml", ProblemsOf(text));
}

const BrokenText kForm[] = {
    {"UnknownKey", "alpha = 3.0", "alpa = 3.0", "controller.alpa", "did you mean \"alpha\"?"},
    {"UnknownKeyBesideTheRightOne", "sigma = 0.02", "sigma = 0.02\nsigmas = 0.02",
     "controller.sigmas", "did you mean \"sigma\"?"},
    {"UnknownSection", "[loop]", "[printer]\nx = 1\n[loop]", "printer",
     "unknown key; known here: extends rig", "[printer]"},
    {"KeyOfAnotherSection", "[safety]", "[safety]\nsoft_angle_deg = [90.0, 90.0]",
     "safety.soft_angle_deg", "did you mean limits.soft_angle_deg?"},
    {"UnknownKeyInARow", "joint = \"rotor2\"", "joint = \"rotor2\"\ngear = 48.96",
     "sensors.encoder[3].gear", "unknown key"},
    {"MissingKey", "period_ms = 20.0", "", "loop.period_ms", "missing", "[loop]"},
    {"MissingSection", "[log]\ndirectory = \"runs\"", "", "log",
     "missing: must be there and be a table, [log]", "no line"},
    {"DuplicateKey", "sign = 1", "sign = 1\nsign = -1", "", "cannot redefine existing integer"},
    {"DuplicateSection", "[loop]", "[safety] # again\n[loop]", "", "cannot redefine", "# again"},
    {"NotToml", "[loop]", "[loop", "", "is not valid TOML"},
    {"TextForANumber", "alpha = 3.0", "alpha = \"3.0\"", "controller.alpha", "a finite number"},
    {"FractionForAWholeNumber", "fault_ticks = 3", "fault_ticks = 2.5", "estimator.fault_ticks",
     "a whole number"},
    {"NumberForText", "name = \"thesis-rig\"", "name = 7", "rig.name", "a string"},
    {"NumberForABoolean", "prediction = true", "prediction = 1", "controller.prediction",
     "true or false"},
    {"NumberForAPair", "motor_lag_ms = [2.0, 2.0]", "motor_lag_ms = 2.0", "sim.motor_lag_ms",
     "an array of 2 finite numbers"},
    {"ThreeNumbersForAPair", "motor_lag_ms = [2.0, 2.0]", "motor_lag_ms = [2.0, 2.0, 2.0]",
     "sim.motor_lag_ms", "an array of 2 finite numbers"},
    {"TextInAPair", "motor_lag_ms = [2.0, 2.0]", "motor_lag_ms = [2.0, \"2\"]",
     "sim.motor_lag_ms[1]", "a finite number"},
    {"TableForRows", "[[link1.section]]", "[link1.section]", "link1.section", "rows, each"},
    {"ValueForASection", "[loop]", "[log2]\n[loop]", "log2", "did you mean \"log\"", "[log2]"},
    {"NotANumber", "alpha = 3.0", "alpha = nan", "controller.alpha", "a finite number"},
    {"Infinite", "length_m = 0.8", "length_m = inf", "link1.section[0].length_m",
     "a finite number"},
    {"HugeSeed", "seed = 1", "seed = 18446744073709551616", "", "is not valid TOML"},
    {"NegativeSeed", "seed = 1", "seed = -1", "sim.seed", "0 or above"},
    {"UnknownDamping", "damping = \"ca_rho\"", "damping = \"ca\"", "arm.damping",
     "\"none\" \"ca_rho\" \"ca_lit\" \"modal\""},
    {"UnknownController", "name = \"sobel\"", "name = \"pid\"", "controller.name", "one of"},
    {"UnknownEstimator", "name = \"kalman\"", "name = \"luenberger\"", "estimator.name", "one of"},
    {"UnknownBackend", "[loop]", "[hal]\nbackend = \"comedi\"\n[loop]", "hal.backend",
     "must be one of \"sim\"", "[hal]\nbackend = "},
    {"BackendSectionWithoutBackend", "[loop]", "[hal]\n[loop]", "hal.backend", "missing", "[hal]"},
    {"ExtendsInAText", "[rig]", "extends = \"other.toml\"\n[rig]", "extends",
     "must be in a config file", "extends = "},
};
INSTANTIATE_TEST_SUITE_P(Form, BrokenConfig, ::testing::ValuesIn(kForm), NameOfCase);

TEST(BrokenConfigs, AreReportedAllAtOnceInOrderOfLine) {
  std::string text = FileText(Shipped("thesis-rig.toml"));
  text = Replaced(text, "length_m = 0.8", "length_m = -0.8");                  // out of range
  text = Replaced(text, "counter_bits = 16", "counter_bits = \"16\"");         // mistyped
  text = Replaced(text, "alpha = 3.0", "alfa = 3.0");                          // unknown
  text = Replaced(text, "soft_angle_deg = [90.0", "soft_angle_deg = [100.0");  // contradictory
  text = Replaced(text, "period_ms = 20.0", "");                               // missing
  try {
    ParseConfig(text, "rig.toml");
    FAIL() << "was accepted";
  } catch (const ConfigError& error) {
    std::vector<std::string> keys;
    for (const ConfigProblem& p : error.problems()) keys.push_back(p.key);
    EXPECT_THAT(keys, ::testing::ElementsAre("link1.section[0].length_m",
                                             "sensors.encoder[3].counter_bits", "controller.alfa",
                                             "limits.soft_angle_deg[0]", "loop.period_ms"));
    const std::string what = error.what();
    EXPECT_EQ(std::count(what.begin(), what.end(), '\n'), 4);  // five lines
    EXPECT_THAT(what, HasSubstr("rig.toml:" + std::to_string(LineOf(text, "length_m = -0.8")) +
                                ": link1.section[0].length_m = -0.8: must be positive\n"));
  }
}

// A key that a file may leave out: it is derived, or has a default.
bool MayBeAbsent(const std::string& key) {
  static const std::vector<std::string> derivable = DerivableKeys();
  return key == "estimator.payload.detect_delay" ||
         std::find(derivable.begin(), derivable.end(), key) != derivable.end();
}

// Tests every key of the file in turn, so that the reader cannot omit one.
class EveryKey : public ::testing::Test {
 protected:
  // The file with its line `i` edited.
  template <typename Edit>
  void ForEachKeyLine(Edit edit) {
    const std::string text = FileText(Shipped("thesis-rig.toml"));
    int keys = 0;
    std::string section;
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = text.find('\n', begin);
      const std::string line = text.substr(begin, end - begin);
      const std::size_t equals = line.find(" = ");
      if (line.starts_with("[")) section = line.substr(1, line.find(']') - 1);
      if (equals != std::string::npos && line[0] != '#') {
        ++keys;
        std::string edited = text;
        edited.replace(begin, line.size(), edit(line, line.substr(0, equals)));
        may_be_absent_ = MayBeAbsent(section + "." + line.substr(0, equals));
        Check(ProblemsOf(edited), line, line.substr(0, equals),
              1 + static_cast<int>(std::count(
                      text.begin(), text.begin() + static_cast<std::ptrdiff_t>(begin), '\n')));
      }
      begin = end + 1;
    }
    EXPECT_GT(keys, 180);
  }

  virtual void Check(const std::vector<ConfigProblem>& problems, const std::string& line,
                     const std::string& key, int number) {
    if (may_be_absent_ && expected_ == "missing") {
      EXPECT_TRUE(problems.empty()) << number << ": " << line;
      return;
    }
    ASSERT_EQ(problems.size(), 1U) << number << ": " << line;
    EXPECT_THAT(problems[0].key, HasSubstr(key)) << problems[0].Text();
    EXPECT_THAT(problems[0].rule, HasSubstr(expected_)) << problems[0].Text();
    EXPECT_TRUE(!same_line_ || problems[0].line == number) << problems[0].Text();
  }

  std::string expected_;
  bool same_line_ = true;
  bool may_be_absent_ = false;
};

TEST_F(EveryKey, IsMissedByName) {
  expected_ = "missing";
  same_line_ = false;
  ForEachKeyLine([](const std::string&, const std::string&) { return std::string(); });
}

TEST_F(EveryKey, IsRefusedWithAValueOfTheWrongType) {
  expected_ = "must be";
  ForEachKeyLine([](const std::string&, const std::string& key) { return key + " = 1979-05-27"; });
}

TEST_F(EveryKey, IsSuggestedWhenMisspelt) {
  expected_ = "did you mean";
  ForEachKeyLine([](const std::string& line, const std::string& key) {
    return key + "x" + line.substr(key.size());
  });
}

}  // namespace
}  // namespace flexarm
