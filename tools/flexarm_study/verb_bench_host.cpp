#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "controller/files/write_file.h"
#include "tools/bench_host/bench_host.h"
#include "tools/bench_host/bench_table.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

constexpr const char* kExperiment = "square-30deg.toml";

struct BenchHostOptions {
  ConfigOptions config;
  OutputOptions page;
  bool quick = false;
  bool json = false;
};

BenchSetting SettingOf(const BenchHostOptions& options) {
  ConfigOptions config = options.config;
  if (!config.given()) {
    config.file = ExperimentsFolder({}, kExperiment).parent_path() / "hil.toml";
  }
  const RigConfig rig = config.Load();
  const ChosenExperiment chosen = ChooseExperiment({}, config.file, rig);
  return {.config_file = config.file,
          .config = rig,
          .experiment = chosen.experiment,
          .programs = std::filesystem::read_symlink("/proc/self/exe").parent_path(),
          .quick = options.quick};
}

int Run(const BenchHostOptions& options) {
  const OutputRules rules{.kind = "a table of bench-host",
                          .mark = kBenchHostMark,
                          .inputs = {options.config.file},
                          .overwrite = options.page.overwrite};
  if (options.page.given()) CheckOutput(options.page.file, rules);
  const BenchSetting setting = SettingOf(options);
  const BenchReport report = RunBenchHost(setting, ProgressBar("rows", BenchRowsOf(setting)));
  if (options.page.given()) {
    WriteFile(options.page.file, BenchMarkdown(report), rules);
    ReportWritten(options.page.file);
  }
  if (options.json) {
    std::cout << PrintedJson(BenchJson(report)) << '\n';
  } else if (!options.page.given()) {
    std::cout << BenchMarkdown(report);
  }
  for (const std::string& warning : WarningsOf(report.machine)) {
    std::cerr << "flexarm: warning: " << warning << '\n';
  }
  return AnyCheckFailed(report) ? Exit::kFailed : Exit::kDone;
}

}  // namespace

void RegisterBenchHost(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<BenchHostOptions>();
  CLI::App* verb = AddOtherVerb(app, "bench-host");
  options->config.AddTo(verb, false);
  verb->add_flag("--quick", options->quick,
                 "Few repetitions, in some seconds: shows that all runs, not how fast");
  options->page.AddTo(verb, "Write the table to this file, in Markdown", false);
  AddJson(verb, &options->json);
  verb->footer(
      "Times are medians; in brackets the quartiles and the number of repetitions. Calculations\n"
      "are timed in processor time, sweep and wake-up in wall time. Floating-point\n"
      "operations are counted in a child process that executes the same code one instruction at a\n"
      "time; the bound is measured in the same run. docs/performance.md explains each row.\n"
      "Takes some minutes on a quiet machine; no row needs root. A row that cannot be measured "
      "says\n"
      "why and what to do: CVODE needs flexarm-cvode-race, ode45 octave-cli, wake-ups cyclictest\n"
      "and the permission for real time, those under load also stress-ng.\n"
      "The config (default: the shipped hil.toml) must have the simulated arm for the wake-ups.\n"
      "JSON: machine, warnings, bounds, rows (name, median_s, lower_quartile_s, "
      "upper_quartile_s,\n"
      "flops, bound_share, ratio, ratio_bar, result, not_measured), build.\n"
      "Exit code 1: a replay is not exact, or the right-hand side for Octave differs; a time is\n"
      "never a failure.\n"
      "Examples: flexarm bench-host\n"
      "          flexarm bench-host -o performance.md\n"
      "          flexarm bench-host -c config/hil.toml --quick --json");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
