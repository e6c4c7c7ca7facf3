#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "config/config.h"
#include "controller/files/external_text.h"
#include "controller/files/failure_text.h"
#include "controller/files/input_error.h"
#include "controller/files/standard_output.h"
#include "controller/host/daemon.h"
#include "controller/realtime/realtime_setup.h"
#include "controller/runlog/build_info.h"
#include "controller/types/rejected_error.h"
#include "hal/bus_device.h"
#include "tools/command_line/guess.h"
#include "tools/command_line/self_description.h"
#include "tools/trip_report/trip_page.h"

namespace flexarm {
namespace {

constexpr int kDone = 0, kFailed = 1, kBadInput = 2;

struct Options {
  std::filesystem::path config;
  std::filesystem::path experiment;
  std::optional<double> run_for_s;
  std::vector<std::string> overrides;
  std::string log_directory;
  std::string state_directory;
  std::string socket;
  bool without_realtime = false;
};

void AddOptions(CLI::App* app, Options* options) {
  app->add_option("-c,--config", options->config, "Config of the rig, a TOML file")
      ->required()
      ->type_name("FILE");
  app->add_option("--experiment", options->experiment,
                  "Arm, run this experiment once, disarm and end; simulated backend only")
      ->type_name("FILE");
  app->add_option("--run-for", options->run_for_s, "Stop, disarm and end after this time")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber);
  app->add_flag("--without-realtime", options->without_realtime,
                "Run even if SCHED_FIFO or locked memory is not permitted");
  app->add_option("--set", options->overrides, "Replace a value of the config; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  app->add_option("--log-dir", options->log_directory,
                  "log.directory of the config, and daemon.state_directory too")
      ->type_name("DIR");
  app->add_option("--state-dir", options->state_directory, "daemon.state_directory of the config")
      ->type_name("DIR");
  app->add_option("--socket", options->socket, "daemon.socket of the config")->type_name("PATH");
}

RigConfig Load(const Options& options) {
  std::vector<std::string> overrides = options.overrides;
  const auto quoted = [](const std::string& text) { return "'" + text + "'"; };
  if (!options.log_directory.empty()) {
    overrides.push_back("log.directory=" + quoted(options.log_directory));
  }
  const std::string& state =
      options.state_directory.empty() ? options.log_directory : options.state_directory;
  if (!state.empty()) overrides.push_back("daemon.state_directory=" + quoted(state));
  if (!options.socket.empty()) overrides.push_back("daemon.socket=" + quoted(options.socket));
  return LoadConfig(options.config, overrides);
}

// Only a simulated arm may move without a command of an operator.
void RequireBackend(const RigConfig& config, const Options& options) {
  if (config.backend.empty()) {
    throw RejectedError(options.config.string() +
                        ": has no [hal] section, so there is no arm to control; use a config with "
                        "hal.backend, such as config/hil.toml");
  }
  if (config.backend == "sim" || options.experiment.empty()) return;
  throw RejectedError(
      "--experiment moves the arm without an operator, and backend '" + config.backend +
      "' drives a real arm: start the daemon without --experiment, then use `flexarm arm` and "
      "`flexarm run`");
}

int Serve(const Options& options) {
  const RigConfig config = Load(options);
  RequireBackend(config, options);
  DaemonOptions daemon{.config = config,
                       .config_file = options.config.string(),
                       .experiment = std::nullopt,
                       .run_for_s = options.run_for_s,
                       .realtime = !options.without_realtime,
                       .parse_experiment = ParseExperiment,
                       .with_law = WithLaw,
                       .trip_page = TripPage};
  if (!options.experiment.empty()) daemon.experiment = LoadExperiment(options.experiment);
  const DaemonResult result = RunDaemon(daemon);
  return result.tripped || result.refused || result.log_errors > 0 ? kFailed : kDone;
}

int PrintError(const std::string& text, int code) {
  std::cerr << "flexarmd: " << ShownMessage(text) << '\n';
  return code;
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App app("The controller daemon of a two-link flexible robot arm. Operate it with `flexarm`.",
               "flexarmd");
  app.set_version_flag("--version", "flexarmd " + ThisBuild().version + " (" + BuildId() + ")");
  AddOptions(&app, &options);
  app.footer(
      "As a service: systemctl start flexarmd.\n"
      "Hardware in the loop: flexarmd --config config/hil.toml\n"
      "                      --experiment config/experiments/square-30deg.toml\n"
      "SIGTERM, SIGINT, SIGQUIT or SIGHUP brings the arm to rest, disarms it, closes the log and "
      "ends.\n"
      "Exit codes: 0 done; 1 tripped and not reset, refused, or a log could not be written; 2 bad "
      "input.");
  try {
    if (const auto code = DescribeItself(app, "flexarmd", 8, argc, argv)) return *code;
    app.parse(argc, argv);
    return Serve(options);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return PrintError(error.what() + GuessFor(app) + "\nTry: flexarmd --help", kBadInput);
  } catch (const RealtimeRejectedError& error) {
    return PrintError(std::string("real-time scheduling is not possible.\n") + error.what(),
                      kFailed);
  } catch (const HalError& error) {
    return PrintError(std::string("a device cannot be used: ") + error.what(), kFailed);
  } catch (const ConfigError& error) {
    return PrintError(error.what(), kBadInput);
  } catch (const RejectedError& error) {
    return PrintError(error.what(), kBadInput);
  } catch (const InputError& error) {
    return PrintError(error.what(), kBadInput);
  } catch (const std::exception& error) {
    return PrintError(FailureText(error), kFailed);
  }
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  try {
    const int code = flexarm::Main(argc, argv);
    const std::string lost = flexarm::FlushStandardOutput();
    return lost.empty() || code != 0 ? code : flexarm::PrintError(lost, 1);
  } catch (...) {  // not even the message could be built
    return 1;
  }
}
