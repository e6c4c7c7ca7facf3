#include "tools/command_line/guess.h"

#include <CLI/CLI.hpp>
#include <optional>
#include <vector>

#include "config/spelling.h"

namespace flexarm {
namespace {

std::string Meant(const std::string& word, const std::vector<std::string>& words) {
  const std::optional<std::string> meant = ClosestWord(word, words);
  return meant ? "; did you mean " + *meant + "?" : std::string();
}

std::vector<std::string> OptionsOf(const CLI::App& verb) {
  std::vector<std::string> names;
  const auto shown = [](const CLI::Option* option) { return !option->get_group().empty(); };
  for (const CLI::Option* option : verb.get_options(shown)) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

std::string GuessVerb(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(verb->get_name());
  }
  return Meant(word, names);
}

std::string GuessFor(const CLI::App& verb) {
  const std::vector<std::string> unexpected = verb.remaining();
  if (unexpected.empty()) return {};
  const std::string& word = unexpected.front();
  if (word.rfind("--", 0) == 0) return Meant(word.substr(0, word.find('=')), OptionsOf(verb));
  return word.rfind('-', 0) == 0 ? std::string() : GuessVerb(verb, word);
}

const CLI::App& InnermostVerb(const CLI::App& app) {
  const std::vector<const CLI::App*> given =
      app.get_subcommands([](const CLI::App* verb) { return verb->parsed(); });
  return given.empty() ? app : InnermostVerb(*given.front());
}

}  // namespace flexarm
