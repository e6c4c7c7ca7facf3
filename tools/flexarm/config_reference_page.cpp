#include "tools/flexarm/config_reference_page.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "config/key_survey.h"

namespace flexarm {
namespace {

void Replace(std::string* text, std::string_view from, std::string_view to) {
  for (std::size_t at = text->find(from); at != std::string::npos;
       at = text->find(from, at + to.size())) {
    text->replace(at, from.size(), to);
  }
}

// "a finite number" and the like, as messages say it, in a word.
std::string ShortType(std::string type) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kShorter = {{
      {"an array of finite numbers", "numbers"},
      {"an array of ", ""},
      {"finite numbers", "numbers"},
      {"a finite number", "number"},
      {"a whole number of at most 9 digits", "whole number"},
      {"a whole number, 0 or above", "whole number, 0 or above"},
      {"a string", "text"},
      {"one of \"", "\""},
      {"\" \"", "\", \""},
  }};
  for (const auto& [longer, shorter] : kShorter) Replace(&type, longer, shorter);
  return type;
}

// "1 .. 6" of "must lie in 1 .. 6: why", the range; a rule in words as it is.
std::string ShortRule(std::string rule) {
  for (const std::string_view range : {"must lie in ", "must be above 0", "must have "}) {
    if (rule.starts_with(range)) rule.resize(std::min(rule.size(), rule.find(": ")));
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kStarts = {
      {{"must lie in ", ""}, {"must not be ", "not "}, {"must be ", ""}}};
  for (const auto& [longer, shorter] : kStarts) {
    if (rule.starts_with(longer)) return std::string(shorter) + rule.substr(longer.size());
  }
  return rule;
}

std::string ValueText(const ListedKey& key) {
  std::string text = ShortType(key.type);
  for (const std::string& rule : key.rules) text += "; " + ShortRule(rule);
  return text;
}

std::string WithoutText(const ListedKey& key) {
  if (!key.without.empty()) return key.without;
  return key.is_required ? "required" : "-";
}

std::string Cell(std::string text) {
  Replace(&text, "|", "\\|");
  return text;
}

void AddRow(const ListedKey& key, std::string* page) {
  const std::string unit = key.unit.empty() ? "" : key.unit;
  *page += "| `" + key.name + "` | " + unit + " | " + Cell(ValueText(key)) + " | " +
           Cell(WithoutText(key)) + " | " + Cell(key.meaning) + " |\n";
}

void AddTable(const KeyListing& reference, const ListedTable& table, std::string* page) {
  std::string rows;
  for (const ListedKey& key : reference.keys) {
    if (key.table == table.path) AddRow(key, &rows);
  }
  if (rows.empty()) return;
  if (!table.name.empty()) *page += "\n### `" + table.name + "`\n\n";
  std::string about = table.meaning;
  if (table.is_optional) about += about.empty() ? "May be left out" : "; may be left out";
  if (!about.empty()) {
    about.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(about.front())));
    *page += about + ".\n\n";
  }
  *page += "| key | unit | value | without it | meaning |\n|---|---|---|---|---|\n" + rows;
}

void AddFile(const KeyListing& reference, std::string* page) {
  AddTable(reference, {}, page);  // the keys above all tables
  for (const ListedTable& table : reference.tables) AddTable(reference, table, page);
}

constexpr const char* kHead =
    "# Config reference\n\n"
    "After reading this page you can say what every key of a config, an experiment or a "
    "description of an arm means, in which unit and range, and what holds without it.\n\n"
    "The program writes this page from the code that reads the files: `flexarm config reference`. "
    "`flexarm config reference KEY` prints one key, a\n"
    "table, or all keys of a name; `--json` prints all for programs. "
    "`flexarm config show FILE` prints the values of a config and where each\n"
    "comes from.\n\n"
    "- A pair `[a, b]` belongs to joint or link 1 and 2, a list of four modal values to f11 f12 "
    "f21 f22. Torques are at the gearbox output.\n"
    "- \"value\" has type and rule; the rules between several keys, and those of the whole wiring, "
    "are in the messages of `flexarm config check` only.\n"
    "- \"without it\" is what holds when the key is left out. \"derived\" values follow from the "
    "arm ([theory/derivation.md](theory/derivation.md) has the symbols\n"
    "  S, J, d, L, F, K); \"required\" keys must be there when their table is; with \"-\" the "
    "meaning says what holds.\n"
    "- A number without a unit has the unit 1, or is a count.\n";

}  // namespace

std::string ReferencePage(const KeyListing& rig, const KeyListing& experiment,
                          const KeyListing& arm) {
  std::string page = kHead;
  page += "\n## Config of a rig\n\n";
  AddFile(rig, &page);
  page += "\n## Experiment\n\nHow to write one: [experiments.md](experiments.md).\n\n";
  AddFile(experiment, &page);
  page +=
      "\n## Description of an arm\n\nThe file of `flexarm config new --from`: "
      "[own-arm.md](own-arm.md). Each key is also an option of the same name.\n\n";
  AddFile(arm, &page);
  return page;
}

nlohmann::ordered_json ReferenceJson(const KeyListing& reference) {
  nlohmann::ordered_json json;
  json["tables"] = nlohmann::ordered_json::array();
  for (const ListedTable& table : reference.tables) {
    json["tables"].push_back({{"path", table.path},
                              {"name", table.name},
                              {"meaning", table.meaning},
                              {"required", !table.is_optional}});
  }
  json["keys"] = nlohmann::ordered_json::array();
  for (const ListedKey& key : reference.keys) {
    json["keys"].push_back({{"key", key.path},
                            {"type", key.type},
                            {"unit", key.unit},
                            {"rules", key.rules},
                            {"required", key.is_required},
                            {"without", key.without},
                            {"meaning", key.meaning}});
  }
  return json;
}

std::vector<ListedKey> KeysMeant(const KeyListing& reference, const std::string& word) {
  const std::string path = KeySurvey::Pattern(word);
  std::vector<ListedKey> meant;
  const auto add_if = [&](const auto& matches) {
    if (!meant.empty()) return;
    std::copy_if(reference.keys.begin(), reference.keys.end(), std::back_inserter(meant), matches);
  };
  add_if([&](const ListedKey& key) { return key.path == path; });
  // "limits.torque_limit_nm[0]", as a message names an element.
  if (path.ends_with("[]")) {
    add_if([&](const ListedKey& key) { return key.path + "[]" == path; });
  }
  add_if([&](const ListedKey& key) {
    return key.path.starts_with(path + ".") || key.path.starts_with(path + "[].");
  });
  add_if([&](const ListedKey& key) { return key.name == path; });
  return meant;
}

std::string ReferenceText(const ListedKey& key) {
  std::string text = key.path + "\n  " + key.meaning + "\n";
  if (!key.unit.empty()) text += "  unit:       " + key.unit + "\n";
  text += "  value:      " + ShortType(key.type) + "\n";
  for (const std::string& rule : key.rules) text += "  rule:       " + rule + "\n";
  return text + "  without it: " + WithoutText(key) + "\n";
}

}  // namespace flexarm
