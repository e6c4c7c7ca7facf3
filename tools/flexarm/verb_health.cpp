#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "controller/files/external_file.h"
#include "controller/files/external_json.h"
#include "controller/files/input_error.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/health/health_table.h"
#include "tools/health/log_health.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

struct HealthOptions {
  RunChoice runs;
  ConfigOptions config;
  bool json = false;
};

// The figures that the daemon of a config keeps.
ShownHealth KeptHealth(const RigConfig& config) {
  const std::filesystem::path file =
      std::filesystem::path(config.daemon.state_directory) / kHealthFileName;
  const FileContent content = ReadExternalFile(file, kHealthFile);
  if (content.problem && content.problem->missing) {
    throw InputError(file.string() +
                     ": there is no such file: flexarmd of this config has kept no run; expected "
                     "run logs, or a config whose daemon.state_directory has " +
                     kHealthFileName);
  }
  if (content.problem) throw InputError(content.problem->Text(file));
  ShownHealth health;
  health.history =
      ParseHistory(content.text, file.string(), DriftChannels(config.arm, config.sensors));
  health.report = ReportOf(config, config.health, health.history);
  return health;
}

// The runs in the order of their starts; of the same second in the order of the command line.
ShownHealth HealthOfLogs(const std::vector<std::filesystem::path>& files) {
  std::vector<LogHealth> logs(files.size());
  ParallelFor(files.size(), [&](std::size_t i) { logs[i] = HealthOfLog(files[i]); });
  std::ranges::stable_sort(logs, [](const LogHealth& a, const LogHealth& b) {
    return a.record.start_utc < b.record.start_utc;
  });
  ShownHealth health;
  for (const LogHealth& log : logs) {
    if (log.record.drift.size() != logs.back().record.drift.size()) {
      throw InputError(log.record.run + ": is of a rig with other gauges or joints than " +
                       logs.back().record.run + "; expected logs of one rig");
    }
    health.history.Add(log.record);
  }
  const RigConfig& config = logs.back().config;
  health.report = ReportOf(config, config.health, health.history);
  health.newest = logs.back().figures;
  return health;
}

int Run(const HealthOptions& options) {
  if (options.runs.given() == options.config.given()) {
    throw InputError("expected run logs, or --config of a daemon that keeps the figures");
  }
  const ShownHealth health =
      options.runs.given() ? HealthOfLogs(options.runs.Files()) : KeptHealth(options.config.Load());
  if (options.json) {
    std::cout << PrintedJson(HealthJson(health)) << '\n';
  } else {
    std::cout << HealthText(health);
  }
  return health.report.AlarmedKeys().empty() ? Exit::kDone : Exit::kFailed;
}

}  // namespace

void RegisterHealth(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<HealthOptions>();
  CLI::App* verb =
      app.add_subcommand("health", "Drifts of gauges, joints, links and payload from run to run");
  options->runs.AddManyTo(verb);
  options->config.AddTo(verb, false);
  AddJson(verb, &options->json);
  verb->footer(
      "Of run logs the parallel plant computes the figures again; with --config those are shown\n"
      "that flexarmd keeps in daemon.state_directory. The runs are compared in the order of their\n"
      "starts; the first half of them, ten at most, is the reference. A figure is relative to\n"
      "config, calibration and the payload that the run states (docs/health.md).\n"
      "Exit code 1 if a channel drifts.\n"
      "Examples: flexarm health runs/*.flexarm\n"
      "          flexarm health -c rig.toml --json");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
