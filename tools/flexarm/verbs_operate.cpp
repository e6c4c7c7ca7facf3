#include <CLI/CLI.hpp>
#include <cstdint>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "controller/operator/arm_verdict.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/daemon_client/daemon_client.h"
#include "tools/flexarm/override_options.h"
#include "tools/flexarm/status_watch.h"
#include "tools/status/reply.h"
#include "tools/status/status_text.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

// The check of the host takes 3 s at most, the tests of the power path as long again.
constexpr double kLongestArm_s = 10.0;

struct OperateOptions {
  DaemonClient daemon;
  std::string line, limits;
  int level = 0;
  bool watch = false;
  double period_s = 0.5;
  OverrideOptions overrides;
};

int Status(const OperateOptions& options) {
  if (options.watch) return WatchStatus(options.daemon, options.period_s);
  const Json answer = options.daemon.Ask({{"command", "status"}});
  if (!FlagIn(answer, "ok")) return options.daemon.Conclude(answer);
  std::cout << (options.daemon.json ? answer.dump(2) + "\n" : StatusText(answer));
  return Exit::kDone;
}

void AddCommand(CLI::App& app, Exit& exit, const char* name, const char* what, const char* footer) {
  const auto options = std::make_shared<OperateOptions>();
  CLI::App* verb = options->daemon.AddVerb(app, name, what);
  if (std::string_view(name) != "stop") options->daemon.AddTakeOver(verb);
  verb->footer(footer);
  verb->callback([options, &exit, name] {
    exit.code = options->daemon.Conclude(options->daemon.Ask({{"command", name}}));
  });
}

void RegisterStatus(CLI::App& app, Exit& exit) {
  const auto status = std::make_shared<OperateOptions>();
  CLI::App* verb = status->daemon.AddVerb(
      app, "status",
      "Show the state of the running daemon: safety, angles, torques, delay, buses, threads");
  CLI::Option* watch = verb->add_flag(
      "--watch", status->watch,
      "Show it as a screen that follows the daemon, until q or Ctrl-C; with --json, or where the "
      "output is no terminal, once a period");
  verb->add_option("--period", status->period_s, "Seconds between two looks of --watch, 0.05 to 60")
      ->check(NumberWithin(0.05, 60.0))
      ->needs(watch)
      ->capture_default_str()
      ->type_name("SECONDS");
  verb->footer(
      "The screen has gauges and torques with their limits, switches, encoders (also disarmed, to\n"
      "check wires by hand), the arm, the run, the buses and the threads (docs/watching.md). It\n"
      "fits the terminal, says when the daemon does not answer, and goes on when it is back.\n"
      "NO_COLOR=1 shows it without colours. --watch --json prints one JSON object a line a "
      "period,\n"
      "the one exception to one object on stdout; {\"ok\":false,\"error\":..} while there is no\n"
      "answer.\n"
      "Examples: flexarm status --watch\n"
      "          flexarm status --watch --json --period 1 > status.jsonl");
  verb->callback([status, &exit] { exit.code = Status(*status); });
}

void RegisterArm(CLI::App& app, Exit& exit) {
  const auto arm = std::make_shared<OperateOptions>();
  CLI::App* verb = arm->daemon.AddVerb(app, "arm", "Close the relay: zero torque, ready to run");
  arm->daemon.AddTakeOver(verb);
  arm->overrides.AddTo(verb, "--override-host", kHostCondition,
                       "Arm a wired rig although this machine is not good enough for one");
  arm->overrides.AddTo(verb, "--override-design", kDesignCondition,
                       "Arm a wired rig although its gains were written with design --force");
  verb->footer(
      "Only from Idle, at rest, with no fault present, with a design that `flexarm design`\n"
      "accepts, and on a wired rig with a machine that `flexarm check-host` finds ready. The\n"
      "REASON of an override, one line of up to 200 bytes, is in the journal, in the run's log\n"
      "and, until the arm is disarmed, in the status (docs/safety.md).\n"
      "Examples: flexarm arm\n"
      "          flexarm arm --override-host \"bench test, drives without power\"");
  verb->callback([arm, &exit] {
    Json command = {{"command", "arm"}};
    arm->overrides.PutInto(&command);
    exit.code = arm->daemon.Conclude(arm->daemon.Ask(command, kLongestArm_s));
  });
}

void RegisterLimits(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<OperateOptions>();
  CLI::App* verb = options->daemon.AddVerb(
      app, "limits", "Reduce the limits of torque, rate and angle, or lift the reduction");
  options->daemon.AddTakeOver(verb);
  verb->add_option("limits", options->limits, "full or reduced")
      ->required()
      ->check(CLI::IsMember({"full", "reduced"}))
      ->type_name("WHICH");
  verb->footer(
      "Only while the arm is disarmed. Reduced limits are the shares safety.reduced_torque,\n"
      "reduced_rate and reduced_angle of those of the config: runs are planned within them, the\n"
      "gate cuts the torque, and the arm trips beyond them. With safety.reduced = true the daemon\n"
      "starts with them. The journal and each run's log say so.\n"
      "Example: flexarm limits full");
  verb->callback([options, &exit] {
    exit.code = options->daemon.Conclude(
        options->daemon.Ask({{"command", "limits"}, {"limits", options->limits}}));
  });
}

}  // namespace

void RegisterOperate(CLI::App& app, Exit& exit) {
  RegisterStatus(app, exit);
  RegisterArm(app, exit);

  RegisterRun(app, exit);
  RegisterPath(app, exit);

  AddCommand(app, exit, "stop", "End the experiment: the controller brings the arm to rest",
             "The controller damps the arm for at most 3 s, then the state is Armed. Example: "
             "flexarm stop");
  AddCommand(app, exit, "disarm", "Open the relay",
             "Only from Armed; stop first. Example: flexarm disarm");
  AddCommand(app, exit, "reset", "Leave Tripped for Idle",
             "Only after the reset button was pressed, at rest, with the cause gone.\n"
             "Example: flexarm reset");

  RegisterLimits(app, exit);

  const auto sim = std::make_shared<OperateOptions>();
  CLI::App* verb = sim->daemon.AddVerb(
      app, "sim", "Set a digital line of the simulated rig: a switch or the reset button");
  verb->add_option(
          "line", sim->line,
          "limit-1-low, limit-1-high, limit-2-low, limit-2-high, emergency-stop, reset-button")
      ->required()
      ->type_name("LINE");
  verb->add_option("level", sim->level, "0 or 1; switches are closed (1) when healthy")
      ->required()
      ->check(CLI::Range(0, 1))
      ->type_name("LEVEL");
  verb->footer(
      "Examples: flexarm sim emergency-stop 0    the emergency stop is pressed\n"
      "          flexarm sim reset-button 1      pressed; 50 ms later 0: released");
  verb->callback([sim, &exit] {
    exit.code = sim->daemon.Conclude(
        sim->daemon.Ask({{"command", "sim"}, {"line", sim->line}, {"level", sim->level}}));
  });
}

}  // namespace flexarm
