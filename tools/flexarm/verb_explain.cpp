#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config/spelling.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "tools/advice/advice_page.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

struct ExplainOptions {
  std::string name;
  bool json = false;
};

// The one of that name or number; otherwise all whose names begin so, as "soft-limit".
std::vector<Advice> AdviceMeant(const std::vector<Advice>& all, const std::string& name) {
  std::vector<Advice> meant;
  const auto add_if = [&](const auto& matches) {
    if (meant.empty()) std::copy_if(all.begin(), all.end(), std::back_inserter(meant), matches);
  };
  add_if([&](const Advice& a) {
    return a.name == name || (a.number > 0 && std::to_string(a.number) == name);
  });
  add_if([&](const Advice& a) { return a.name.starts_with(name + "-"); });
  return meant;
}

std::vector<std::string> NamesOf(const std::vector<Advice>& all) {
  std::vector<std::string> names;
  for (const Advice& advice : all) names.push_back(advice.name);
  return names;
}

[[noreturn]] void FailUnknownName(const std::string& name, const std::vector<Advice>& all) {
  const std::optional<std::string> close = ClosestWord(name, NamesOf(all));
  const bool is_key = name.find('.') != std::string::npos;
  throw InputError("no trip and no refusal is called " + Shown(name) + "; " +
                   (close    ? "did you mean " + *close + "?"
                    : is_key ? "`flexarm config reference " + Shown(name) + "` explains a key"
                             : "expected a name as `flexarm status` shows it, such as "
                               "soft-limit-1, or its number; `flexarm explain` lists all"));
}

void Explain(const ExplainOptions& options) {
  std::vector<Advice> advice = AllAdvice();
  if (!options.name.empty()) {
    std::vector<Advice> meant = AdviceMeant(advice, options.name);
    if (meant.empty()) FailUnknownName(options.name, advice);
    advice = std::move(meant);
  }
  if (options.json) {
    std::cout << PrintedJson(AdviceJson(advice)) << '\n';
  } else if (options.name.empty()) {
    std::cout << AdvicePage(advice);
  } else {
    for (const Advice& one : advice) std::cout << AdviceText(one);
  }
}

}  // namespace

void RegisterExplain(CLI::App& app, Exit&) {
  const auto options = std::make_shared<ExplainOptions>();
  CLI::App* verb =
      app.add_subcommand("explain", "What a trip or a refusal means, what to check and what to do");
  CLI::Option* name =
      verb->add_option("name", options->name,
                       "Name or number of a trip, name of a refusal; several if it is the "
                       "beginning of several names")
          ->type_name("NAME");
  OfferWords(name, [] { return NamesOf(AllAdvice()); });
  AddJson(verb, &options->json);
  verb->footer(
      "Without NAME it prints all, as a page in Markdown: docs/trips.md.\n"
      "Examples: flexarm explain soft-limit-1\n"
      "          flexarm explain no-log\n"
      "Needs no daemon.");
  verb->callback([options] { Explain(*options); });
}

}  // namespace flexarm
