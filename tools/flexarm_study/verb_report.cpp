#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/report/report.h"

namespace flexarm {
namespace {

struct ReportOptions {
  ConfigOptions config;
  std::filesystem::path output;
  std::string laws;
  int runs = 5;
  bool json = false;
};

void Run(const ReportOptions& options) {
  const std::filesystem::path experiments = ExperimentsFolder(options.config.file, kBenchmarkFile);
  const RigConfig config = options.config.Load();
  const std::filesystem::path page =
      WriteReport({.config = config,
                   .experiment = ChooseExperiment({}, options.config.file, config).experiment,
                   .experiments = experiments,
                   .published = experiments.parent_path() / "published" / "cases.toml",
                   .folder = options.output,
                   .laws = options.laws,
                   .runs = options.runs});
  if (options.json) {
    std::cout << PrintedJson(nlohmann::ordered_json{{"page", page.string()}}) << '\n';
  } else {
    std::cout << "Open " << page.string() << " in a browser; it needs no network\n";
  }
}

}  // namespace

void RegisterReport(CLI::App& app, Exit&) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* verb = AddOtherVerb(app, "report");
  options->config.AddTo(verb, true);
  verb->add_option("-o,--output", options->output, "Folder to write, new or empty")
      ->required()
      ->type_name("DIR");
  verb->add_option("--laws", options->laws,
                   "Only these laws in the benchmark, by name, separated by commas")
      ->type_name("NAMES");
  verb->add_option("--runs", options->runs, "Runs of random moves for each law and scenario")
      ->type_name("N")
      ->check(NumberWithin(1, 1000))
      ->capture_default_str();
  AddJson(verb, &options->json);
  verb->footer(
      "DIR/report.html needs no other file; figures/, tables/ and runs/ hold the data behind it.\n"
      "Takes some minutes. The chapters of the thesis are in the report of its arm alone.\n"
      "Example: flexarm report -c config/hil.toml -o report");
  verb->callback([options] { Run(*options); });
}

}  // namespace flexarm
