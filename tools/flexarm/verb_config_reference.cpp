#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/new_rig/arm_reference.h"
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

/// The keys of each kind of file.
struct Listings {
  KeyListing rig = RigReference(), experiment = ExperimentReference(), arm = ArmReference();
};

// What may be asked for: keys, with and without their tables, and tables.
std::vector<std::string> WordsOf(const Listings& listings) {
  std::vector<std::string> words;
  for (const KeyListing* reference : {&listings.rig, &listings.experiment, &listings.arm}) {
    for (const ListedKey& key : reference->keys) {
      words.push_back(key.path);
      words.push_back(key.name);
    }
    for (const ListedTable& table : reference->tables) words.push_back(table.path);
  }
  return words;
}

[[noreturn]] void FailUnknown(const std::string& word, const Listings& listings) {
  const std::optional<std::string> close = ClosestWord(word, WordsOf(listings));
  throw InputError("no config, experiment or description of an arm has a key or table " +
                   Shown(word) + "; " +
                   (close ? "did you mean " + *close + "?"
                          : "`flexarm config reference` lists all, and `flexarm config reference "
                            "limits` those of a table"));
}

void PrintJson(const Listings& listings) {
  std::cout << PrintedJson({{"rig", ReferenceJson(listings.rig)},
                            {"experiment", ReferenceJson(listings.experiment)},
                            {"arm", ReferenceJson(listings.arm)}})
            << '\n';
}

void PrintKeys(const char* head, const KeyListing& listing) {
  if (!listing.keys.empty()) std::cout << head;
  for (const ListedKey& key : listing.keys) std::cout << ReferenceText(key);
}

void Print(const ReferenceOptions& options) {
  const Listings all;
  if (options.key.empty()) {
    if (options.json) {
      PrintJson(all);
    } else {
      std::cout << ReferencePage(all.rig, all.experiment, all.arm);
    }
    return;
  }
  const auto meant = [&](const KeyListing& reference) {
    return KeyListing{.tables = {}, .keys = KeysMeant(reference, options.key)};
  };
  const Listings asked{
      .rig = meant(all.rig), .experiment = meant(all.experiment), .arm = meant(all.arm)};
  if (asked.rig.keys.empty() && asked.experiment.keys.empty() && asked.arm.keys.empty()) {
    FailUnknown(options.key, all);
  }
  if (options.json) return PrintJson(asked);
  PrintKeys("", asked.rig);
  PrintKeys("In an experiment:\n", asked.experiment);
  PrintKeys("In a description of an arm:\n", asked.arm);
}

}  // namespace

void RegisterConfigReference(CLI::App& config, Exit&) {
  const auto options = std::make_shared<ReferenceOptions>();
  CLI::App* verb = config.add_subcommand(
      "reference",
      "Print what every key of a config, an experiment and a description of an arm means: unit, "
      "range, value without it");
  CLI::Option* key =
      verb->add_option("key", options->key,
                       "Only this key, the keys of this table, or all keys of this name")
          ->type_name("KEY");
  OfferWords(key, [] { return WordsOf({}); });
  AddJson(verb, &options->json);
  verb->footer(
      "Without KEY it prints a page in Markdown, docs/config-reference.md.\n"
      "Example: flexarm config reference limits.torque_limit_nm");
  verb->callback([options] { Print(*options); });
}

}  // namespace flexarm
