#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "config/thesis_arm.h"
#include "controller/files/external_json.h"
#include "controller/files/input_error.h"
#include "controller/files/write_file.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"
#include "tools/thesis/thesis_check.h"

namespace flexarm {
namespace {

struct ThesisCheckOptions {
  ConfigOptions config;
  bool json = false;
  int first_seed = 1;
  OutputOptions output;
};

void Analyze(const ThesisCheckOptions& options) {
  const RigConfig config = options.config.Load();
  if (const std::string differs = DiffersFromThesisArm(config.arm); !differs.empty()) {
    throw InputError(options.config.file.string() +
                     ": the statements of the thesis are about its arm: " + differs);
  }
  const OutputRules rules =
      options.output.Rules("such a page", kThesisCheckTitle, {options.config.file});
  if (options.output.given()) CheckOutput(options.output.file, rules);
  const std::vector<Statement> statements =
      ThesisStatements(config, options.first_seed, ProgressBar("chapters", 6));
  const std::string page = ThesisCheckPage(config, statements);
  if (options.output.given()) {
    WriteFile(options.output.file, page, rules);
    ReportWritten(options.output.file);
  }
  if (options.json) {
    std::cout << PrintedJson(StatementsJson(statements)) << '\n';
  } else if (!options.output.given()) {
    std::cout << page;
  }
}

}  // namespace

void RegisterAnalyzeCheck(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<ThesisCheckOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "check", "Check the statements of the thesis against the model, with computed numbers");
  options->config.AddTo(verb, true);
  verb->add_option("--first-seed", options->first_seed,
                   "Seed of the first of the runs of chapter 7 (default: 1); the verdicts should "
                   "not depend on it")
      ->check(NumberWithin(1.0, 1e6));
  AddJson(verb, &options->json);
  options->output.AddTo(verb, "Markdown page to write", false);
  verb->footer(
      "Prints a table: section, statement, result of the model, verdict.\n"
      "Example: flexarm analyze check -c config/thesis-rig.toml -o docs/thesis-check.md");
  verb->callback([options] { Analyze(*options); });
}

}  // namespace flexarm
