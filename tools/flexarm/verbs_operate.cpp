#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "controller/operator/arm_verdict.h"
#include "tools/command_line/verbs.h"
#include "tools/flexarm/daemon_client.h"
#include "tools/flexarm/override_options.h"
#include "tools/flexarm/reply.h"
#include "tools/flexarm/status_text.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

// The check of the host takes 3 s at most, the tests of the power path as long again.
constexpr double kLongestArm_s = 10.0;

struct OperateOptions {
  DaemonClient daemon;
  std::string line;
  int level = 0;
  bool watch = false;
  OverrideOptions overrides;
};

int Status(const OperateOptions& options) {
  for (;;) {
    const Json answer = options.daemon.Ask({{"command", "status"}});
    if (!FlagIn(answer, "ok")) return options.daemon.Conclude(answer);
    if (options.daemon.json) {
      std::cout << answer.dump(2) << '\n';
    } else {
      if (options.watch) std::cout << "\033[H\033[2J";
      std::cout << StatusText(answer);
    }
    std::cout.flush();
    if (!options.watch) return Exit::kDone;
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
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

}  // namespace

void RegisterOperate(CLI::App& app, Exit& exit) {
  const auto status = std::make_shared<OperateOptions>();
  CLI::App* verb = status->daemon.AddVerb(
      app, "status",
      "Show the state of the running daemon: safety, angles, torques, delay, buses, threads");
  verb->add_flag("--watch", status->watch, "Repeat every half second until interrupted");
  verb->footer("Example: flexarm status --watch");
  verb->callback([status, &exit] { exit.code = Status(*status); });

  RegisterArm(app, exit);

  RegisterRun(app, exit);

  AddCommand(app, exit, "stop", "End the experiment: the controller brings the arm to rest",
             "The controller damps the arm for at most 3 s, then the state is Armed. Example: "
             "flexarm stop");
  AddCommand(app, exit, "disarm", "Open the relay",
             "Only from Armed; stop first. Example: flexarm disarm");
  AddCommand(app, exit, "reset", "Leave Tripped for Idle",
             "Only after the reset button was pressed, at rest, with the cause gone.\n"
             "Example: flexarm reset");

  const auto sim = std::make_shared<OperateOptions>();
  verb = sim->daemon.AddVerb(
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
