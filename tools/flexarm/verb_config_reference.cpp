#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/spelling.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/flexarm/config_reference_page.h"

namespace flexarm {
namespace {

struct ReferenceOptions {
  std::string key;
  bool json = false;
};

// What may be asked for: keys, with and without their tables, and tables.
std::vector<std::string> WordsOf(const KeyListing& rig, const KeyListing& experiment) {
  std::vector<std::string> words;
  for (const KeyListing* reference : {&rig, &experiment}) {
    for (const ListedKey& key : reference->keys) {
      words.push_back(key.path);
      words.push_back(key.name);
    }
    for (const ListedTable& table : reference->tables) words.push_back(table.path);
  }
  return words;
}

[[noreturn]] void FailUnknown(const std::string& word, const KeyListing& rig,
                              const KeyListing& experiment) {
  const std::optional<std::string> close = ClosestWord(word, WordsOf(rig, experiment));
  throw InputError("no config and no experiment has a key or table " + Shown(word) + "; " +
                   (close ? "did you mean " + *close + "?"
                          : "`flexarm config reference` lists all, and `flexarm config reference "
                            "limits` those of a table"));
}

void Print(const ReferenceOptions& options) {
  KeyListing rig = RigReference(), experiment = ExperimentReference();
  if (!options.key.empty()) {
    std::vector<ListedKey> of_rig = KeysMeant(rig, options.key);
    std::vector<ListedKey> of_experiment = KeysMeant(experiment, options.key);
    if (of_rig.empty() && of_experiment.empty()) FailUnknown(options.key, rig, experiment);
    rig = {.tables = {}, .keys = std::move(of_rig)};
    experiment = {.tables = {}, .keys = std::move(of_experiment)};
  }
  if (options.json) {
    std::cout << PrintedJson(
                     {{"rig", ReferenceJson(rig)}, {"experiment", ReferenceJson(experiment)}})
              << '\n';
  } else if (options.key.empty()) {
    std::cout << ReferencePage(rig, experiment);
  } else {
    for (const ListedKey& key : rig.keys) std::cout << ReferenceText(key);
    if (!experiment.keys.empty()) std::cout << "In an experiment:\n";
    for (const ListedKey& key : experiment.keys) std::cout << ReferenceText(key);
  }
}

}  // namespace

void RegisterConfigReference(CLI::App& config, Exit&) {
  const auto options = std::make_shared<ReferenceOptions>();
  CLI::App* verb = config.add_subcommand(
      "reference",
      "Print what every key of a config and of an experiment means: unit, range, value without it");
  CLI::Option* key =
      verb->add_option("key", options->key,
                       "Only this key, the keys of this table, or all keys of this name")
          ->type_name("KEY");
  OfferWords(key, [] { return WordsOf(RigReference(), ExperimentReference()); });
  AddJson(verb, &options->json);
  verb->footer(
      "Without KEY it prints a page in Markdown, docs/config-reference.md.\n"
      "Example: flexarm config reference limits.torque_limit_nm");
  verb->callback([options] { Print(*options); });
}

}  // namespace flexarm
