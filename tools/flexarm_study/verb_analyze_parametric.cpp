#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <memory>
#include <optional>

#include "controller/files/external_json.h"
#include "controller/files/write_file.h"
#include "tools/analysis/parametric_report.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"
#include "tools/thesis/parametric_statements.h"

namespace flexarm {
namespace {

struct ParametricOptions {
  ConfigOptions config;
  Excitation excitation;
  std::optional<std::array<double, 2>> motor_lag_ms;  // empty: the config's
  bool json = false;
  OutputOptions output;
};

void Analyze(ParametricOptions& options) {
  const RigConfig config = options.config.Load();
  options.excitation.motor_lag_ms = options.motor_lag_ms.value_or(config.sim.motor_lag_ms);
  if (options.output.given()) MakeOutputFolder(options.output.file, options.output.overwrite);
  const std::size_t runs = ParametricRuns(config);
  const ParametricStudy study =
      RunParametricStudy(config, options.excitation, ProgressBar("runs", runs));
  const std::vector<Statement> statements =
      ParametricStatements(study, RunParametricStudy(config, Strong(options.excitation),
                                                     ProgressBar("runs, more torque", runs)));
  if (options.output.given()) {
    for (const auto& file : WriteParametricFolder(study, statements, options.output.file)) {
      ReportWritten(file);
    }
  }
  if (options.json) {
    std::cout << PrintedJson(ParametricJson(study, statements)) << '\n';
  } else {
    PrintStatements(statements);
  }
}

}  // namespace

void RegisterAnalyzeParametric(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<ParametricOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "parametric",
      "Effect of payload, stiffness, friction, backlash and lengths on the vibrations (chapter 5)");
  options->config.AddTo(verb, true);
  verb->add_option("--torque-nm", options->excitation.torque_nm,
                   "Amplitudes of the square wave of 1 s on both motors, N m; the statements are "
                   "also checked with five times these torques")
      ->type_name("T1 T2")
      ->check(NumberWithin(1e-6, 1e3))
      ->default_str("0.4 0.1");
  verb->add_option("--motor-lag-ms", options->motor_lag_ms,
                   "Time constants of the motors' torques (3.24) (default: sim.motor_lag_ms)")
      ->type_name("T1 T2")
      ->check(NumberWithin(0.0, 1000.0));
  AddJson(verb, &options->json);
  options->output.AddTo(
      verb, "Folder for pictures like figures 5.1 to 5.5, all results as CSV, and the table", false,
      "DIR");
  verb->footer(
      "Varies one parameter at a time and prints which statements of the thesis hold.\n"
      "Example: flexarm analyze parametric -c config/thesis-rig.toml -o parametric");
  verb->callback([options] { Analyze(*options); });
}

}  // namespace flexarm
