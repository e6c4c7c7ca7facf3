#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"
#include "tools/support/text_file.h"
#include "tools/thesis/thesis_check.h"

namespace flexarm {
namespace {

struct ThesisCheckOptions {
  ConfigOptions config;
  bool json = false;
  std::filesystem::path output;
};

void Analyze(const ThesisCheckOptions& options) {
  const RigConfig config = options.config.Load();
  const std::vector<Statement> statements = ThesisStatements(config, ProgressBar("chapters", 5));
  const std::string page = ThesisCheckPage(config, statements);
  if (!options.output.empty()) {
    WriteText(options.output, page);
    std::cerr << "wrote " << options.output.string() << '\n';
  }
  if (options.json) {
    std::cout << StatementsJson(statements).dump(2) << '\n';
  } else if (options.output.empty()) {
    std::cout << page;
  }
}

}  // namespace

void RegisterAnalyzeCheck(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<ThesisCheckOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "check", "Check the statements of the thesis against the model, with computed numbers");
  options->config.AddTo(verb, true);
  AddJson(verb, &options->json);
  verb->add_option("-o,--output", options->output, "Markdown page to write")->type_name("FILE");
  verb->footer(
      "Prints a table: section, statement, result of the model, verdict.\n"
      "Example: flexarm analyze check -c config/thesis-rig.toml -o docs/thesis-check.md");
  verb->callback([options] { Analyze(*options); });
}

}  // namespace flexarm
