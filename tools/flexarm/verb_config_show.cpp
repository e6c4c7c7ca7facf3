#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "config/shown_config.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

struct ShowOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;
  std::string only;
  bool json = false;
};

void PrintText(const std::vector<ShownValue>& values) {
  constexpr std::size_t kWidest = 60;
  std::size_t width = 0;
  for (const ShownValue& shown : values) {
    width = std::max(width, std::min(shown.key.size() + 3 + shown.value.size(), kWidest));
  }
  for (const ShownValue& shown : values) {
    const std::string line = shown.key + " = " + shown.value;
    std::printf("%-*s  # %s\n", static_cast<int>(width), Shown(line).c_str(),
                Shown(shown.origin).c_str());
  }
}

void Show(const ShowOptions& options) {
  LoadConfig(options.file, options.overrides);  // reports what is wrong with it
  std::vector<ShownValue> values = ShownConfig(options.file, options.overrides);
  std::erase_if(values,
                [&](const ShownValue& shown) { return !shown.key.starts_with(options.only); });
  if (!options.json) {
    PrintText(values);
    return;
  }
  nlohmann::ordered_json json;
  json["values"] = nlohmann::ordered_json::array();
  for (const ShownValue& shown : values) {
    json["values"].push_back({{"key", shown.key},
                              {"value", shown.value},
                              {"origin", shown.origin},
                              {"file", shown.file},
                              {"line", shown.line},
                              {"derived", shown.file.empty()}});
  }
  std::cout << PrintedJson(json) << '\n';
}

}  // namespace

void RegisterConfigShow(CLI::App& config, Exit&) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* verb = config.add_subcommand(
      "show",
      "Print every value of a config with its source: the file and line, --set, or the rule by "
      "which it was derived");
  verb->add_option("file", options->file, "Config of the rig, a TOML file")
      ->required()
      ->type_name("FILE");
  AddSet(verb, &options->overrides);
  verb->add_option("--only", options->only, "Only keys that begin with this, such as limits")
      ->type_name("SECTION");
  AddJson(verb, &options->json);
  verb->footer(
      "Example: flexarm config show config/hil.toml --only controller\n"
      "A value that a config leaves out and that can be derived follows the arm: see\n"
      "docs/theory/derivation.md.");
  verb->callback([options] { Show(*options); });
}

}  // namespace flexarm
