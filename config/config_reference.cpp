#include "config/config_reference.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "config/derivation/derivation.h"
#include "config/document.h"
#include "config/experiment_file.h"
#include "config/key_survey.h"
#include "config/key_units.h"
#include "config/problem_log.h"
#include "config/rig_binding.h"
#include "config/section_rules.h"
#include "config/table_reader.h"
#include "controller/runlog/csv_import.h"

namespace flexarm {
namespace {

using Rules = std::map<std::string, std::vector<std::string>>;  // by the path of the key

// "limits.torque_limit_nm[1]", an element, belongs to the key "limits.torque_limit_nm". The rule of
// the last element is that of all: the first knot of a grid has another one, which the key's
// meaning states.
void NoteRules(const std::vector<Problem>& problems, Rules* rules) {
  std::map<std::string, std::string> element;  // of a path: the key of the rules that are noted
  for (const Problem& problem : problems) {
    std::string path = KeySurvey::Pattern(problem.key);
    std::string& noted = element[path];
    const bool is_element = path.ends_with("[]");
    if (is_element) path.resize(path.size() - 2);
    std::vector<std::string>& known = (*rules)[path];
    if (is_element && !noted.empty() && noted != problem.key) known.clear();
    noted = problem.key;
    if (std::find(known.begin(), known.end(), problem.rule) == known.end()) {
      known.push_back(problem.rule);
    }
  }
}

// "hal.canopen[].node[]" is "[[hal.canopen.node]]" in a file.
std::string HeaderOf(const std::string& path) {
  if (path.empty()) return "";
  std::string name;
  for (const char c : path) {
    if (c != '[' && c != ']') name += c;
  }
  return path.ends_with("[]") ? "[[" + name + "]]" : "[" + name + "]";
}

std::pair<std::string, std::string> TableAndName(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) return {"", path};
  return {path.substr(0, dot), path.substr(dot + 1)};
}

ListedKey KeyOf(const SurveyedKey& key, const Rules& rules) {
  auto [table, name] = TableAndName(key.path);
  const bool is_number = key.wanted.find("number") != std::string::npos;
  std::string unit = key.unit;
  if (unit.empty() && is_number) unit = UnitOfName(name);
  const auto found = rules.find(key.path);
  return {.path = key.path,
          .table = std::move(table),
          .name = std::move(name),
          .type = key.wanted,
          .unit = std::move(unit),
          .meaning = key.meaning,
          .is_required = !key.is_optional,
          .without = key.without,
          .rules = found == rules.end() ? std::vector<std::string>() : found->second};
}

KeyListing ReferenceOf(const KeySurvey& survey, const Rules& rules) {
  KeyListing reference;
  for (const SurveyedTable& table : survey.tables()) {
    reference.tables.push_back({.name = HeaderOf(table.path),
                                .path = table.path,
                                .meaning = table.meaning,
                                .is_optional = table.is_optional});
  }
  for (const SurveyedKey& key : survey.keys()) reference.keys.push_back(KeyOf(key, rules));
  return reference;
}

void AddDerivations(KeyListing* reference) {
  for (const DerivedValue& derived : DeriveSomeArm()) {
    const auto key = std::find_if(reference->keys.begin(), reference->keys.end(),
                                  [&](const ListedKey& k) { return k.path == derived.key; });
    if (key == reference->keys.end()) continue;
    key->is_required = false;
    key->without = "derived: " + derived.how;
  }
}

// Adds the rules that both passes found. One that quotes a number that was not read is a rule
// between values.
void AddCommonRules(const Rules& first, const Rules& second, Rules* all) {
  for (const auto& [path, rules] : first) {
    const auto again = second.find(path);
    if (again == second.end()) continue;
    std::vector<std::string>& known = (*all)[path];
    for (const std::string& rule : rules) {
      const auto among = [&rule](const std::vector<std::string>& list) {
        return std::find(list.begin(), list.end(), rule) != list.end();
      };
      const bool quotes_unread = rule.find("nan") != std::string::npos;
      if (among(again->second) && !among(known) && !quotes_unread) known.push_back(rule);
    }
  }
}

// Runs `read` on a config without a document; the rules that the numbers of the survey violate are
// all there are, but for those between valid values.
template <typename Config>
KeyListing Survey(const std::function<void(TableReader root, Config*)>& read,
                  const std::function<void(const Config&, bool second, Rules*)>& note_rules) {
  KeySurvey survey;
  Rules rules, first;
  const toml::table empty;
  survey.Run([&](KeySurvey* pass) {
    ProblemLog log("", &empty);
    Config config{};
    read(TableReader(pass, "", &log), &config);
    Rules now;
    note_rules(config, pass->second(), &now);
    if (pass->second()) AddCommonRules(first, now, &rules);
    first = std::move(now);
  });
  return ReferenceOf(survey, rules);
}

void NoteRulesOfRig(const RigConfig& config, bool second, Rules* rules) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<Problem>& problems : RulesOfArm(config)) NoteRules(problems, rules);
  for (const std::vector<Problem>& problems : RulesOfRest(config, {kUnknown, kUnknown})) {
    NoteRules(problems, rules);
  }
  if (!config.csv) return;
  SensorConfig sensors{};
  if (second) sensors.encoder.resize(1);
  NoteRules(ProblemsOf(*config.csv, sensors), rules);
}

}  // namespace

KeyListing RigReference() {
  KeyListing reference = Survey<RigConfig>(ReadRig, NoteRulesOfRig);
  AddDerivations(&reference);
  reference.keys.insert(reference.keys.begin(), {.path = kExtendsKey,
                                                 .table = "",
                                                 .name = kExtendsKey,
                                                 .type = "a string",
                                                 .unit = "",
                                                 .meaning = kExtendsMeaning,
                                                 .is_required = false,
                                                 .without = "",
                                                 .rules = {}});
  return reference;
}

KeyListing ExperimentReference() {
  return Survey<Experiment>(ReadExperiment,
                            [](const Experiment& experiment, bool /*second*/, Rules* rules) {
                              NoteRules(experiment.Problems(), rules);
                            });
}

}  // namespace flexarm
