#include "tools/command_line/completion.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "tools/command_line/option_value.h"

namespace flexarm {
namespace {

using Words = std::vector<std::string>;
using Offers = std::map<const CLI::Option*, std::function<Words()>>;

// Filled while the verbs of this process are registered, by one thread.
Offers& AllOffers() {
  static Offers offers;
  return offers;
}

// The words that a check of the option lists: "TEXT:{low,high}".
Words ListedWords(const std::string& type) {
  const std::size_t begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos || end < begin) return {};
  std::istringstream list(type.substr(begin + 1, end - begin - 1));
  Words words;
  for (std::string word; std::getline(list, word, ',');) {
    words.push_back(word.substr(0, word.find("->")));
  }
  return words;
}

bool IsOneOf(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

Completion ValueOf(const CLI::Option& option) {
  if (const auto offer = AllOffers().find(&option); offer != AllOffers().end()) {
    return {.words = offer->second()};
  }
  const std::string type = option.get_type_name();
  if (Words words = ListedWords(type); !words.empty()) return {.words = std::move(words)};
  if (type == "DIR") return {.words = {}, .paths = Completion::Paths::kFolders};
  if (IsOneOf(type, {"FILE", "PATH", "RUN", "RUN..", "RUN_OR_CSV", "EXPERIMENT", "ARM.toml"})) {
    return {.words = {}, .paths = Completion::Paths::kFiles};
  }
  return {};
}

// The names of the options of a verb, long ones first.
Words OptionNames(const CLI::App& verb) {
  Words names;
  const auto options = verb.get_options([](const CLI::Option* o) {
    return o->nonpositional() && !o->get_group().empty();  // those that --help shows
  });
  for (const CLI::Option* option : options) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::Option* option : options) {
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

// Where a command line stands after its whole words.
class Place {
 public:
  explicit Place(const CLI::App& program) : verb_(&program) {}

  void Take(const std::string& word) {
    if (word == "=") return;  // bash splits --config=FILE at its breaks
    if (awaits_ != nullptr) {
      awaits_ = nullptr;
    } else if (word.size() > 1 && word.front() == '-') {
      TakeOption(word);
    } else if (const CLI::App* below = Below(word)) {
      verb_ = below;
      arguments_ = 0;
    } else {
      ++arguments_;
    }
  }

  Completion Next(const std::string& begun) const {
    if (awaits_ != nullptr) return ValueOf(*awaits_);
    if (!begun.empty() && begun.front() == '-') return {.words = OptionNames(*verb_)};
    Completion completion = ArgumentValue();
    const auto any = [](const CLI::App*) { return true; };
    for (const CLI::App* below : verb_->get_subcommands(any)) {
      completion.words.push_back(below->get_name());
    }
    return completion;
  }

 private:
  void TakeOption(const std::string& word) {
    if (word.find('=') != std::string::npos) return;
    const auto named = [&word](const CLI::Option* o) { return o->check_name(word); };
    const auto options = verb_->get_options(named);
    if (!options.empty() && TakesValue(*options.front())) awaits_ = options.front();
  }

  const CLI::App* Below(const std::string& word) const {
    const auto named = [&word](const CLI::App* app) { return app->check_name(word); };
    const auto found = verb_->get_subcommands(named);
    return found.empty() ? nullptr : found.front();
  }

  // Of the next argument; the last one may be given several times.
  Completion ArgumentValue() const {
    const auto arguments =
        verb_->get_options([](const CLI::Option* o) { return o->get_positional(); });
    if (arguments.empty()) return {};
    const std::size_t last = arguments.size() - 1;
    if (arguments_ > last && arguments[last]->get_items_expected_max() <= 1) return {};
    return ValueOf(*arguments[std::min(arguments_, last)]);
  }

  const CLI::App* verb_;
  const CLI::Option* awaits_ = nullptr;  // an option whose value comes next
  std::size_t arguments_ = 0;            // of the verb, so far
};

}  // namespace

Completion Complete(const CLI::App& program, const std::vector<std::string>& words) {
  if (words.empty()) return {};
  Place place(program);
  std::for_each(words.begin(), words.end() - 1, [&](const std::string& w) { place.Take(w); });
  const std::string begun = words.back() == "=" ? "" : words.back();
  Completion completion = place.Next(begun);
  std::erase_if(completion.words, [&](const std::string& w) { return !w.starts_with(begun); });
  return completion;
}

std::string CompletionText(const Completion& completion) {
  std::string text;
  for (const std::string& word : completion.words) text += word + "\n";
  if (completion.paths == Completion::Paths::kFiles) text += ":files\n";
  if (completion.paths == Completion::Paths::kFolders) text += ":folders\n";
  return text;
}

void OfferWords(const CLI::Option* option, std::function<std::vector<std::string>()> words) {
  AllOffers()[option] = std::move(words);
}

}  // namespace flexarm
