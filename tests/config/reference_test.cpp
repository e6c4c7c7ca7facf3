#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "config/config_reference.h"
#include "config/derivation/derivation.h"
#include "config/key_survey.h"
#include "config/shown_config.h"
#include "config/table_reader.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

const KeyListing& Rig() {
  static const KeyListing rig = RigReference();
  return rig;
}
const KeyListing& ForExperiments() {
  static const KeyListing experiment = ExperimentReference();
  return experiment;
}

const ListedKey& KeyAt(const KeyListing& listing, const std::string& path) {
  const auto found = std::find_if(listing.keys.begin(), listing.keys.end(),
                                  [&](const ListedKey& key) { return key.path == path; });
  if (found == listing.keys.end()) throw std::runtime_error("not listed: " + path);
  return *found;
}

TEST(ConfigReference, SaysOfEveryKeyWhatItMeansAndOfEveryNumberItsUnit) {
  for (const KeyListing* listing : {&Rig(), &ForExperiments()}) {
    std::set<std::string> paths;
    for (const ListedKey& key : listing->keys) {
      SCOPED_TRACE(key.path);
      EXPECT_TRUE(paths.insert(key.path).second) << "listed twice";
      EXPECT_THAT(key.meaning, Not(IsEmpty()));
      EXPECT_NE(key.meaning.back(), '.');
      EXPECT_THAT(key.type, Not(IsEmpty()));
      if (key.type.find("finite number") != std::string::npos) {
        EXPECT_THAT(key.unit, Not(IsEmpty())) << "give it with the meaning";
      }
    }
  }
}

// The numbers of the survey are in no rule: one that quotes another value is not listed.
TEST(ConfigReference, ListsNoRuleThatQuotesAnotherValue) {
  for (const ListedKey& key : Rig().keys) {
    for (const std::string& rule : key.rules) {
      EXPECT_THAT(rule, Not(HasSubstr("nan"))) << key.path;
      EXPECT_THAT(rule, Not(HasSubstr("99999"))) << key.path;
      EXPECT_THAT(rule, Not(HasSubstr("uses it too"))) << key.path;
    }
  }
}

TEST(ConfigReference, ListsEveryKeyOfTheShippedFiles) {
  const auto check = [](const std::filesystem::path& folder, const KeyListing& listing) {
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() != ".toml" || entry.path().filename() == "cases.toml") continue;
      ++files;
      for (const ShownValue& shown : ShownConfig(entry.path(), {})) {
        EXPECT_NO_THROW(KeyAt(listing, KeySurvey::Pattern(shown.key))) << entry.path();
      }
    }
    EXPECT_GT(files, 2);
  };
  check(Shipped(""), Rig());
  check(Shipped("published"), Rig());
  check(Shipped("experiments"), ForExperiments());
}

// "hal.canopen[].node[].gear" as a document with this key alone, and with another key beside it.
std::string DocumentOf(const std::string& path, const std::string& beside) {
  const std::size_t dot = path.find('.');
  if (dot == std::string::npos) return path + " = 0" + beside;
  const std::string head = path.substr(0, dot), below = DocumentOf(path.substr(dot + 1), beside);
  if (!head.ends_with("[]")) return head + " = {" + below + "}";
  return head.substr(0, head.size() - 2) + " = [{" + below + "}]";
}

template <typename Parse>
bool IsKnown(const std::string& path, const std::string& beside, const Parse& parse) {
  const std::vector<ConfigProblem> problems = ProblemsFrom(
      [&] { parse(DocumentOf(path, beside.empty() ? "" : ", " + beside), "rig.toml"); });
  return std::none_of(problems.begin(), problems.end(), [&](const ConfigProblem& problem) {
    return problem.rule.starts_with("unknown key") && KeySurvey::Pattern(problem.key) == path;
  });
}

// The words of `type`, "one of \"tcp\" \"rtu\"", as values.
std::vector<std::string> WordsOf(const std::string& type) {
  std::vector<std::string> words;
  for (std::size_t at = type.find('"'); at != std::string::npos; at = type.find('"', at)) {
    const std::size_t end = type.find('"', at + 1);
    words.push_back(type.substr(at, end + 1 - at));
    at = end + 1;
  }
  return words;
}

// Some keys are read only beside a word, as `baud` beside transport = "rtu", or beside a key, as
// `level` beside `line`.
template <typename Parse>
bool IsKnownSomewhere(const ListedKey& key, const KeyListing& listing, const Parse& parse) {
  if (IsKnown(key.path, "", parse)) return true;
  for (const ListedKey& other : listing.keys) {
    if (other.table != key.table || other.path == key.path) continue;
    std::vector<std::string> values = WordsOf(other.type);
    if (values.empty()) values = {"0"};
    for (const std::string& value : values) {
      if (IsKnown(key.path, other.name + " = " + value, parse)) return true;
    }
  }
  return false;
}

TEST(ConfigReference, ListsNoKeyThatTheReaderRefuses) {
  for (const ListedKey& key : Rig().keys) {
    if (key.path == "extends") continue;  // a key of files, not of a text
    EXPECT_TRUE(IsKnownSomewhere(key, Rig(), ParseConfig)) << key.path;
  }
  for (const ListedKey& key : ForExperiments().keys) {
    EXPECT_TRUE(IsKnownSomewhere(key, ForExperiments(), ParseExperiment)) << key.path;
  }
  EXPECT_FALSE(IsKnown("limits.torque_limit", "", ParseConfig)) << "the test sees an unknown key";
}

TEST(ConfigReference, SaysWhatHoldsWithoutAKey) {
  EXPECT_EQ(KeyAt(Rig(), "log.reserve_mb").without, "50");
  EXPECT_EQ(KeyAt(Rig(), "log.required").without, "true");
  EXPECT_EQ(KeyAt(ForExperiments(), "move[].profile").without, "\"quintic\"");
  EXPECT_TRUE(KeyAt(Rig(), "limits.torque_limit_nm").is_required);
  EXPECT_EQ(KeyAt(Rig(), "limits.torque_limit_nm").without, "");
  EXPECT_FALSE(KeyAt(Rig(), "hal.gpiod.relay_contact").is_required);
  for (const std::string& path : DerivableKeys()) {
    EXPECT_FALSE(KeyAt(Rig(), path).is_required) << path;
    EXPECT_THAT(KeyAt(Rig(), path).without, StartsWith("derived: ")) << path;
  }
}

TEST(ConfigReference, TakesRulesFromTheCodeThatChecksThem) {
  EXPECT_THAT(KeyAt(Rig(), "limits.torque_limit_nm").rules,
              ElementsAre(StartsWith("must be above 0 and at most 1000")));
  EXPECT_THAT(KeyAt(Rig(), "sim.plant_modes").rules, ElementsAre(StartsWith("must lie in 1 .. 6")));
  EXPECT_THAT(KeyAt(Rig(), "link2.section[].length_m").rules, ElementsAre("must be positive"));
  EXPECT_THAT(KeyAt(ForExperiments(), "prbs[].bits").rules,
              ElementsAre(StartsWith("must lie in 2 .. 12")));
}

TEST(ConfigReference, SaysWhichTablesMayBeLeftOut) {
  const auto optional = [](const std::string& name) {
    const auto found = std::find_if(Rig().tables.begin(), Rig().tables.end(),
                                    [&](const ListedTable& table) { return table.name == name; });
    return found == Rig().tables.end() ? std::nullopt : std::optional(found->is_optional);
  };
  EXPECT_EQ(optional("[limits]"), false);
  EXPECT_EQ(optional("[hal]"), true);
  EXPECT_EQ(optional("[[hal.canopen.node]]"), false);
  EXPECT_EQ(optional("[estimator.payload]"), true);
}

// A reader with every kind of branch.
void ReadToy(TableReader root) {
  int kind = 0;
  root.Read("kind", &kind, {{"plain", 0}, {"rich", 1}}, "what it is");
  double number = 0.0;
  if (kind == 1) root.Read("gold_kg", &number, "of the rich");
  if (root.Has("a") && root.Has("b")) return root.Refuse("a", "must not be given beside b");
  if (root.Has("a")) root.Read("a", &number, "in place of b");
  if (root.Has("b")) root.Read("b", &number, {"in place of a", "m"});
  double third = 0.3;
  root.ReadIfGiven("third", &third, "with a default");
  if (root.Has("part")) root.Table("part", "a part").Read("inner", &number, "inside");
}

TEST(KeySurvey, FindsTheKeysOfEveryBranch) {
  KeySurvey survey;
  const toml::table empty;
  survey.Run([&](KeySurvey* pass) {
    ProblemLog log("", &empty);
    ReadToy(TableReader(pass, "", &log));
    EXPECT_NO_THROW(log.ThrowIfAny());
  });
  std::set<std::string> found;
  for (const SurveyedKey& key : survey.keys()) found.insert(key.path);
  EXPECT_EQ(found, (std::set<std::string>{"kind", "gold_kg", "a", "b", "third", "part.inner"}));
  for (const SurveyedKey& key : survey.keys()) {
    EXPECT_EQ(key.is_optional, key.path == "a" || key.path == "b" || key.path == "third");
    if (key.path == "third") {
      EXPECT_EQ(key.without, "0.3");
    }
    if (key.path == "b") {
      EXPECT_EQ(key.unit, "m");
    }
  }
  ASSERT_EQ(survey.tables().size(), 1U);
  EXPECT_TRUE(survey.tables().front().is_optional);
}

TEST(KeySurvey, APatternHasNoNumbersOfRows) {
  EXPECT_EQ(KeySurvey::Pattern("hal.canopen[0].node[12].gear"), "hal.canopen[].node[].gear");
}

}  // namespace
}  // namespace flexarm
