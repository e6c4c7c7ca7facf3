#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/types/experiment.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/daemon_client/daemon_client.h"

// Verbs that change the path of a run while it goes on. A new goal: `move --retarget`,
// verbs_run.cpp.

namespace flexarm {
namespace {

// A change is planned ahead of the loop, with more time if the experiment is long.
constexpr double kLongestChange_s = 20.0;

struct PathOptions {
  DaemonClient daemon;
  double percent = 100.0;
};

void AddVerb(CLI::App& app, Exit& exit, const char* name, const char* what, const char* footer) {
  const auto options = std::make_shared<PathOptions>();
  CLI::App* verb = options->daemon.AddVerb(app, name, what);
  options->daemon.AddTakeOver(verb);
  verb->footer(footer);
  verb->callback([options, &exit, name] {
    exit.code =
        options->daemon.Conclude(options->daemon.Ask({{"command", name}}, kLongestChange_s));
  });
}

}  // namespace

void RegisterPath(CLI::App& app, Exit& exit) {
  AddVerb(app, exit, "pause", "Bring the running arm to rest on its path",
          "Of a law that follows a path (gain-scheduled, receding-horizon). The arm slows down on\n"
          "its path within the limits, 1.3 to 5.3 s after the command, and rests there under "
          "control,\n"
          "armed, until `flexarm resume`. To end the run instead: `flexarm stop`, for every law.\n"
          "Example: flexarm pause");
  AddVerb(app, exit, "resume", "Go on after a pause, at the speed before it",
          "Example: flexarm resume");

  const auto options = std::make_shared<PathOptions>();
  CLI::App* verb =
      options->daemon.AddVerb(app, "speed", "Change the speed of the run along its path");
  options->daemon.AddTakeOver(verb);
  verb->add_option("percent", options->percent, "Share of the planned speed, 10 to 100")
      ->required()
      ->check(NumberWithin(100.0 * kLeastSpeed, 100.0))
      ->type_name("PERCENT");
  verb->footer(
      "Of a law that follows a path. The path stays the same, and is never faster than it was\n"
      "planned and checked. Another law keeps the speed of `flexarm run --speed`.\n"
      "Example: flexarm speed 30");
  verb->callback([options, &exit] {
    exit.code = options->daemon.Conclude(options->daemon.Ask(
        {{"command", "speed"}, {"speed_percent", options->percent}}, kLongestChange_s));
  });
}

}  // namespace flexarm
