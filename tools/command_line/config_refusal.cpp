#include "tools/command_line/config_refusal.h"

#include <CLI/CLI.hpp>

#include "controller/files/input_error.h"

namespace flexarm {
namespace {

constexpr const char* kReadsNoConfig =
    "this verb reads no config; `flexarm VERB --help` lists the options of a verb";
constexpr const char* kOfTheVerb =
    "it belongs after the verb, as in `flexarm simulate -c FILE --set KEY=VALUE`";

// "runs tag" of flexarm.
std::string NameOf(const CLI::App& verb) {
  const CLI::App* parent = verb.get_parent();
  const std::string above = parent == nullptr ? std::string() : NameOf(*parent);
  return above.empty() || parent->get_parent() == nullptr ? verb.get_name()
                                                          : above + " " + verb.get_name();
}

void Refuse(CLI::App* verb, const std::string& names, const char* shown, const char* why) {
  verb->add_option_function<std::string>(
          names,
          [verb, shown, why](const std::string&) {
            throw InputError(NameOf(*verb) + ": " + shown + " has no effect here: " + why);
          })
      ->group("")  // hidden
      ->expected(0, 1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

}  // namespace

void RefuseSet(CLI::App* verb, const char* why) { Refuse(verb, "--set", "--set", why); }

void RefuseConfig(CLI::App* verb, const char* why) {
  RefuseSet(verb, why);
  Refuse(verb, "-c,--config", "--config", why);
}

void RefuseConfigElsewhere(CLI::App* app) {
  const auto verbs = app->get_subcommands([](CLI::App*) { return true; });
  if (app->get_option_no_throw("--set") == nullptr) {
    RefuseConfig(app, verbs.empty() ? kReadsNoConfig : kOfTheVerb);
  }
  for (CLI::App* verb : verbs) RefuseConfigElsewhere(verb);
}

}  // namespace flexarm
