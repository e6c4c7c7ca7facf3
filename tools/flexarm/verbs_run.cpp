#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "config/experiment_file.h"
#include "controller/operator/prove_switches.h"
#include "controller/operator/run_command.h"
#include "controller/runlog/run_label.h"
#include "tools/command_line/label_options.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/daemon_client/daemon_client.h"
#include "tools/daemon_client/move_text.h"
#include "tools/flexarm/override_options.h"
#include "tools/flexarm/run_wait.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

// Moves without duration_s take 2 ms each to plan, and an experiment has some thousands at most.
constexpr double kLongestPlan_s = 60.0;

/// What every verb that starts a run has.
struct RunOptions {
  DaemonClient daemon;
  bool wait = false;
  double speed_percent = 100.0;
  OverrideOptions overrides;
  LabelOptions label;

  void AddTo(CLI::App* verb) {
    daemon.AddTakeOver(verb);
    verb->add_flag("--wait", wait, "Wait for the end of the run; Ctrl-C stops it");
    verb->add_option("--speed", speed_percent,
                     "Share of the planned speed in percent, 10 to 100; of a law that follows a "
                     "path `flexarm speed` changes it while it runs")
        ->check(NumberWithin(100.0 * kLeastSpeed, 100.0))
        ->type_name("PERCENT");
    label.AddTo(verb);
    overrides.AddTo(verb, "--override-switches", kSwitchesCondition,
                    "Run a wired rig although its switches have not been proved");
    overrides.AddTo(verb, "--override-experiment", kExperimentCondition,
                    "Run although the experiment is not for this law, or is predicted to trip");
  }

  /// @param name  of the experiment, for messages  @returns exit code
  int Run(const std::string& name, const std::string& experiment) const {
    Json command{{"command", "run"}, {"name", name}, {"experiment", experiment}};
    if (speed_percent != 100.0) command["speed_percent"] = speed_percent;
    overrides.PutInto(&command);
    if (const RunLabel given = label.Label(); given != RunLabel{}) {
      command["label"] = LabelToJson(given);
    }
    if (wait) return RunAndWait(daemon, command, kLongestPlan_s);
    return daemon.Conclude(daemon.Ask(command, kLongestPlan_s));
  }
};

struct MoveOptions {
  RunOptions run;
  std::array<double, 2> to_deg{}, to_tip_m{};
  std::string elbow;
  double duration_s = 0.0;
  bool retarget = false;
};

MoveWish WishOf(const MoveOptions& options, bool to_tip) {
  MoveWish wish{.elbow = options.elbow, .duration_s = options.duration_s};
  (to_tip ? wish.to_tip_m : wish.to_deg) = to_tip ? options.to_tip_m : options.to_deg;
  return wish;
}

void RegisterMove(CLI::App& app, Exit& exit) {
  const auto move = std::make_shared<MoveOptions>();
  CLI::App* verb = move->run.daemon.AddVerb(
      app, "move", "Move the armed arm to a place: angles of its joints, or of its tip");
  CLI::Option* to = verb->add_option("--to", move->to_deg, "Angles of joint 1 and 2, in degrees")
                        ->type_name("DEG DEG");
  CLI::Option* to_tip =
      verb->add_option("--to-tip", move->to_tip_m, "Place of the tip, x and y, in metres")
          ->type_name("M M")
          ->excludes(to);
  verb->add_option("--elbow", move->elbow, "left or right of the line from shoulder to tip")
      ->check(CLI::IsMember({"left", "right"}))
      ->type_name("SIDE")
      ->needs(to_tip);
  verb->add_option("--duration", move->duration_s,
                   "Seconds that the move takes; without it: the shortest within plan_fraction of "
                   "every limit")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  CLI::Option* retarget = verb->add_flag(
      "--retarget", move->retarget,
      "Turn the run that goes on towards this place instead, without a stop; what is left of it is "
      "dropped. Of a law that follows a path");
  move->run.AddTo(verb);
  for (const char* option : {"--wait", "--speed", "--name", "--note", "--tag"}) {
    verb->get_option(option)->excludes(retarget);
  }
  verb->footer(
      "Only from Armed, but with --retarget. It is an experiment of one move that ends a second "
      "after it: the daemon\n"
      "plans it from where the arm stands, checks it against every limit before anything moves,\n"
      "and logs it as any other run. A negative number follows its option as it is.\n"
      "Examples: flexarm move --to 20 -10 --wait\n"
      "          flexarm move --to-tip 0.6 0.3 --elbow left --duration 3\n"
      "          flexarm move --to 0 0 --retarget");
  verb->callback([move, to, to_tip, &exit] {
    if (to->count() + to_tip->count() == 0) throw CLI::RequiredError("--to or --to-tip");
    const MoveWish wish = WishOf(*move, to_tip->count() > 0);
    const DaemonClient& daemon = move->run.daemon;
    exit.code = move->retarget ? daemon.Conclude(daemon.Ask(RetargetCommand(wish), kLongestPlan_s))
                               : move->run.Run("move", MoveText(wish));
  });
}

}  // namespace

void RegisterRun(CLI::App& app, Exit& exit) {
  struct Options {
    RunOptions run;
    std::filesystem::path experiment;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* verb = options->run.daemon.AddVerb(app, "run", "Run an experiment on the armed arm");
  verb->add_option("experiment", options->experiment, "Experiment, a TOML file")
      ->required()
      ->type_name("EXPERIMENT");
  options->run.AddTo(verb);
  verb->footer(
      "Only from Armed. The daemon first compares the reference with the limits of the rig: a\n"
      "refusal names the row, the joint, the value and the limit (docs/experiments.md).\n"
      "An experiment that states laws or payload_kg is also simulated before it runs, with the\n"
      "least, the middle and the greatest payload: a refusal names a law that works. A wired rig\n"
      "needs the proof of its switches (flexarm prove-switches). With --wait the exit code is the\n"
      "run's: 0 if it ended as planned, 1 if it was stopped or tripped.\n"
      "Name, note and tags go into the log: `flexarm runs` finds it by them.\n"
      "Examples: flexarm run --wait config/experiments/square-30deg.toml\n"
      "          flexarm run square-30deg.toml --name \"new gauge\" --tag bench --tag gauge-7");
  verb->callback([options, &exit] {
    const Experiment experiment = LoadExperiment(options->experiment);  // throws with file and line
    exit.code = options->run.Run(options->experiment.filename().string(), experiment.text);
  });
  RegisterMove(app, exit);
}

}  // namespace flexarm
