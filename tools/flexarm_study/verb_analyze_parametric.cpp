#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <memory>
#include <optional>

#include "config/thesis_arm.h"
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
  std::optional<std::array<double, 2>> torque_nm, motor_lag_ms;  // empty: the config's
  bool json = false;
  OutputOptions output;
};

Excitation ExcitationOf(const ParametricOptions& options, const RigConfig& config) {
  Excitation excitation = ExcitationFor(config);
  if (options.torque_nm) excitation.torque_nm = *options.torque_nm;
  if (options.motor_lag_ms) excitation.motor_lag_ms = *options.motor_lag_ms;
  return excitation;
}

void Analyze(const ParametricOptions& options) {
  const RigConfig config = options.config.Load();
  const Excitation excitation = ExcitationOf(options, config);
  const bool is_thesis = IsThesisArm(config.arm);
  if (options.output.given()) MakeOutputFolder(options.output.file, options.output.overwrite);
  const std::size_t runs = ParametricRuns(config);
  const ParametricStudy study = RunParametricStudy(config, excitation, ProgressBar("runs", runs));
  std::vector<Statement> statements;
  if (is_thesis) {
    statements = ParametricStatements(
        study,
        RunParametricStudy(config, Strong(excitation), ProgressBar("runs, more torque", runs)));
  }
  if (options.output.given()) {
    for (const auto& file : WriteParametricFolder(study, statements, options.output.file)) {
      ReportWritten(file);
    }
  }
  if (options.json) {
    std::cout << PrintedJson(ParametricJson(study, statements)) << '\n';
  } else if (is_thesis) {
    PrintStatements(statements);
  } else {
    PrintSweeps(study);
  }
}

}  // namespace

void RegisterAnalyzeParametric(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<ParametricOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "parametric",
      "Effect of payload, stiffness, friction, backlash and lengths on the vibrations (chapter 5)");
  options->config.AddTo(verb, true);
  verb->add_option("--torque-nm", options->torque_nm,
                   "Amplitudes of the square wave of 1 s on both motors, N m; the statements are "
                   "also checked with five times these torques (default: 1/75 and 1/60 of the "
                   "torque limits)")
      ->type_name("T1 T2")
      ->check(NumberWithin(1e-6, 1e3));
  verb->add_option("--motor-lag-ms", options->motor_lag_ms,
                   "Time constants of the motors' torques (3.24) (default: sim.motor_lag_ms)")
      ->type_name("T1 T2")
      ->check(NumberWithin(0.0, 1000.0));
  AddJson(verb, &options->json);
  options->output.AddTo(
      verb, "Folder for pictures like figures 5.1 to 5.5, all results as CSV, and the table", false,
      "DIR");
  verb->footer(
      "Varies one parameter at a time and prints which statements of the thesis hold; for another\n"
      "arm, whose statements they are not, the frequencies and the largest bending.\n"
      "Example: flexarm analyze parametric -c config/thesis-rig.toml -o parametric");
  verb->callback([options] { Analyze(*options); });
}

}  // namespace flexarm
