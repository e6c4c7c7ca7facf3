#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "tools/command_line/options.h"
#include "tools/command_line/studies.h"
#include "tools/command_line/verbs.h"
#include "tools/report/report.h"

namespace flexarm {
namespace {

struct ReportOptions {
  ConfigOptions config;
  std::filesystem::path output;
  bool json = false;
};

void Run(const ReportOptions& options) {
  const std::filesystem::path experiments = ExperimentsFolder(options.config.file);
  const std::filesystem::path page =
      WriteReport({.config = options.config.LoadWithCrossSections(),
                   .experiments = experiments,
                   .published = experiments.parent_path() / "published" / "cases.toml",
                   .folder = options.output});
  if (options.json) {
    std::cout << PrintedJson(nlohmann::ordered_json{{"page", page.string()}}) << '\n';
  } else {
    std::cout << "Open " << page.string() << " in a browser; it needs no network\n";
  }
}

}  // namespace

void RegisterReport(CLI::App& app, Exit&) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* verb = AddStudy(app, "report");
  options->config.AddTo(verb, true);
  verb->add_option("-o,--output", options->output, "Folder to write, new or empty")
      ->required()
      ->type_name("DIR");
  AddJson(verb, &options->json);
  verb->footer(
      "DIR/report.html needs no other file; figures/, tables/ and runs/ hold the data behind it.\n"
      "Takes some minutes.\n"
      "Example: flexarm report -c config/hil.toml -o report");
  verb->callback([options] { Run(*options); });
}

}  // namespace flexarm
