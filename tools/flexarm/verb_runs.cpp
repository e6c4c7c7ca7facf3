#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <memory>

#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/runlog/run_labels_file.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/runs/run_search.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

struct RunsOptions {
  std::filesystem::path folder = "runs";
  RunSearch search;
  std::size_t last = 0;  // 0: all
  bool json = false;
};

struct LabelChange {
  std::filesystem::path run;
  std::vector<std::string> words;
};

OrderedJson ToJson(const ListedRun& run) {
  OrderedJson json = {{"run", run.file.string()}, {"problem", TextOrNull(run.problem)}};
  if (!run.problem.empty()) return json;
  const RunInfo& info = run.head.info;
  json["start_utc"] = info.start_utc;
  json["name"] = TextOrNull(run.label.name);
  json["note"] = TextOrNull(run.label.note);
  json["tags"] = run.label.tags;
  json["rig"] = info.rig_name;
  json["backend"] = info.backend;
  json["experiment"] = TextOrNull(info.experiment_name);
  json["law"] = TextOrNull(info.law);
  json["payload_kg"] = info.payload_kg ? NumberOrNull(*info.payload_kg) : OrderedJson(nullptr);
  json["ended"] = ToString(run.head.end);
  json["trip"] = TextOrNull(run.head.trip);
  json["duration_s"] =
      run.head.duration_s ? NumberOrNull(*run.head.duration_s) : OrderedJson(nullptr);
  return json;
}

std::string Number(const std::optional<double>& value, const char* format) {
  std::array<char, 32> text;
  if (!value) return "-";
  std::snprintf(text.data(), text.size(), format, *value);
  return text.data();
}

std::string Ended(const RunHead& head) {
  if (head.end == RunEnd::kTripped) return head.trip;
  if (head.end != RunEnd::kOpen) return ToString(head.end);
  return head.state == RunState::kWritten ? "is being written" : "left: flexarm log recover";
}

void PrintLine(const ListedRun& run) {
  if (!run.problem.empty()) {
    std::cout << "unreadable  " << ShownMessage(run.problem) << '\n';
    return;
  }
  const RunInfo& info = run.head.info;
  std::string words = run.label.name;
  for (const std::string& tag : run.label.tags) words += (words.empty() ? "#" : " #") + tag;
  const auto cell = [](const std::string& text, std::size_t width) {
    std::string shown = Shown(text.empty() ? "-" : text, width);
    shown.resize(std::max(shown.size(), width), ' ');
    return shown + "  ";
  };
  std::cout << cell(info.start_utc, 20) << cell(info.experiment_name, 20) << cell(info.law, 16)
            << cell(Number(info.payload_kg, "%.3f kg"), 9)
            << cell(Number(run.head.duration_s, "%.1f s"), 9) << cell(Ended(run.head), 18)
            << cell(words, 40) << Shown(run.file.filename().string(), kMessageBytes) << '\n';
}

void List(const RunsOptions& options) {
  std::vector<ListedRun> runs = ListRuns(options.folder);
  const bool searches = options.search.trip || !options.search.text.empty() ||
                        !options.search.tag.empty() || !options.search.law.empty();
  std::erase_if(runs, [&](const ListedRun& run) {
    return searches && (!run.problem.empty() || !Matches(run, options.search));
  });
  if (options.last > 0 && runs.size() > options.last) runs.resize(options.last);
  if (options.json) {
    OrderedJson json = {{"runs", OrderedJson::array()}};
    for (const ListedRun& run : runs) json["runs"].push_back(ToJson(run));
    std::cout << PrintedJson(json) << '\n';
    return;
  }
  for (const ListedRun& run : runs) PrintLine(run);
  if (runs.empty()) std::cerr << "flexarm: no such run in " << options.folder.string() << '\n';
}

void ReportLabel(const RunLabel& label) {
  std::cout << PrintedJson({{"name", TextOrNull(label.name)},
                            {"note", TextOrNull(label.note)},
                            {"tags", label.tags}})
            << '\n';
}

// A verb that changes what a run is called: RUN, then words.
void AddChange(CLI::App* runs, const char* name, const char* what, const char* word,
               void (*change)(RunLabel* label, const std::vector<std::string>& words)) {
  const auto options = std::make_shared<LabelChange>();
  CLI::App* verb = runs->add_subcommand(name, what);
  RefuseConfig(verb, kLogHasItsConfig);
  verb->add_option("run", options->run, "Run log")->required()->type_name("RUN");
  verb->add_option("words", options->words, word)->required()->type_name("TEXT..");
  verb->footer(
      "The log itself is not changed, and replays as before: the change stands in\n"
      "flexarm-labels.json of its folder, which goes with the logs.\n"
      "Example: flexarm runs " +
      std::string(name) + " runs/today.flexarm \"gauge 7 was loose\"");
  verb->callback([options, change] {
    ReportLabel(ChangeLabel(options->run, [&](RunLabel* label) { change(label, options->words); }));
  });
}

void AddTags(RunLabel* label, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (std::ranges::find(label->tags, word) == label->tags.end()) label->tags.push_back(word);
  }
}

void RemoveTags(RunLabel* label, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (std::erase(label->tags, word) == 0) {
      throw InputError("no tag '" + Shown(word) + "'; expected one that the run has");
    }
  }
}

void SetNote(RunLabel* label, const std::vector<std::string>& words) {
  label->note.clear();
  for (const std::string& word : words) label->note += (label->note.empty() ? "" : " ") + word;
}

}  // namespace

void RegisterRuns(CLI::App& app, Exit&) {
  const auto options = std::make_shared<RunsOptions>();
  CLI::App* verb =
      app.add_subcommand("runs", "List the run logs of a folder, find them, tag them, note");
  RefuseConfig(verb, kLogHasItsConfig);
  AddRunFolder(verb, &options->folder);
  verb->add_option("--text", options->search.text,
                   "Only runs with this text in name, note, tags, experiment or file; repeatable")
      ->type_name("TEXT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--tag", options->search.tag, "Only runs with this tag; repeatable")
      ->type_name("WORD")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->add_option("--law", options->search.law, "Only runs of this control law")
      ->type_name("NAME");
  verb->add_option("--trip", options->search.trip, "Only runs that tripped by this cause, or any")
      ->type_name("CAUSE");
  verb->add_option("--last", options->last, "Only the newest N, one without N")
      ->type_name("[N]")
      ->expected(0, 1)
      ->default_str("1");
  AddJson(verb, &options->json);
  verb->footer(
      "Newest first: when, experiment, law, payload of the simulated arm, duration, how it ended,\n"
      "name and tags, file. Files that cannot be read come last, with the reason.\n"
      "Examples: flexarm runs --last 10\n"
      "          flexarm runs --tag bench --trip any\n"
      "          flexarm runs --text \"new gauge\" --json");
  AddChange(verb, "tag", "Add tags to a run", "Tags", AddTags);
  AddChange(verb, "untag", "Remove tags of a run", "Tags", RemoveTags);
  AddChange(verb, "note", "Replace the note of a run", "Note", SetNote);
  verb->callback([options, verb] {
    if (verb->get_subcommands().empty()) List(*options);
  });
}

}  // namespace flexarm
