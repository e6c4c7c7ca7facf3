#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/command_line/verbs.h"
#include "tools/daemon_client/daemon_client.h"
#include "tools/status/reply.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLongest_s = 120.0;  // a search for a switch over 180 deg at 5 deg/s, and to rest

struct CommissionOptions {
  DaemonClient daemon;
  std::vector<double> angle_deg;
  int link = 1;
  double force_n = 0.0;
  double at_m = 0.0;
  int joint = 1;
  std::string side;
};

void PrintStrain(const Json& answer) {
  std::printf("%-14s %12s %12s %10s\n", "channel", "zero", "gain error", "noise");
  for (const Json& row : ListIn(answer, "strain")) {
    std::printf("%-14s %8.2f cts %10.2f %% %6.2f cts\n", TextIn(row, "channel").c_str(),
                NumberIn(row, "zero_counts"), 100.0 * NumberIn(row, "gain_error"),
                NumberIn(row, "sigma_counts"));
  }
}

void PrintEncoders(const Json& answer) {
  for (const Json& row : ListIn(answer, "encoder")) {
    std::printf("%-8s zero at %s counts\n", TextIn(row, "joint").c_str(),
                FigureIn(row, "zero_counts", 0).c_str());
  }
}

void PrintPluck(const Json& answer) {
  std::printf("%-14s %10s %10s\n", "channel", "gain", "explained");
  for (const Json& row : ListIn(answer, "answer")) {
    std::printf("%-14s %10.3f %8.1f %%%s\n", TextIn(row, "channel").c_str(), NumberIn(row, "gain"),
                100.0 * NumberIn(row, "match"),
                FlagIn(row, "provable", true) ? "" : "   response too small to judge");
  }
}

int Run(const CommissionOptions& options, const Json& command) {
  const Json answer = options.daemon.Ask(command, kLongest_s);
  if (!options.daemon.json) {
    if (answer.contains("strain")) PrintStrain(answer);
    if (answer.contains("encoder")) PrintEncoders(answer);
    if (answer.contains("answer")) PrintPluck(answer);
  }
  return options.daemon.Conclude(answer);
}

void AddTare(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<CommissionOptions>();
  CLI::App* verb =
      options->daemon.AddVerb(app, "tare", "Tare: measure the zeros of the strain channels");
  options->daemon.AddTakeOver(verb);
  verb->footer(
      "Only in Idle or Tripped, at rest, with nothing touching the links, so that they are not\n"
      "bent. If a channel is unsteady, missing or far from its zero, it is named and no zero is\n"
      "changed.\n"
      "Example: flexarm tare");
  verb->callback([options, &exit] { exit.code = Run(*options, {{"command", "tare"}}); });
}

void AddZero(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<CommissionOptions>();
  CLI::App* verb = options->daemon.AddVerb(
      app, "zero", "Set the present angles of the joints, from which the encoders then count");
  options->daemon.AddTakeOver(verb);
  verb->add_option("--angle-deg", options->angle_deg,
                   "Hub angles of joint 1 and 2, counter-clockwise positive (default 0 0)")
      ->expected(2)
      ->type_name("A B");
  verb->footer(
      "Only in Idle or Tripped, at rest. After a trip by wrong zeros: zero, button, reset.\n"
      "Examples: flexarm zero                     both at zero\n"
      "          flexarm zero --angle-deg 0 90    on a jig");
  verb->callback([options, &exit] {
    Json command{{"command", "zero"}};
    if (!options->angle_deg.empty()) command["angle_deg"] = options->angle_deg;
    exit.code = Run(*options, command);
  });
}

void AddCalibrate(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<CommissionOptions>();
  CLI::App* verb = options->daemon.AddVerb(app, "calibrate",
                                           "Measure the strain gains of a link under a known load");
  options->daemon.AddTakeOver(verb);
  verb->add_option("--link", options->link, "1 or 2")->required()->check(CLI::Range(1, 2));
  verb->add_option(
          "--force-n", options->force_n,
          "Force perpendicular to the link, N; counter-clockwise about its joint is positive")
      ->required();
  verb->add_option("--at-m", options->at_m,
                   "Point of attack of the force, m from the root of the link")
      ->required();
  verb->footer(
      "First `flexarm tare`. Then hold the joint, hang a known mass over a pulley at the end of\n"
      "the link (force = mass times 9.81), and run this verb; further loads refine\n"
      "the gains. Only in Idle.\n"
      "Example: 0.5 kg at the end of link 1: flexarm calibrate --link 1 --force-n 4.905 --at-m "
      "0.8");
  verb->callback([options, &exit] {
    exit.code = Run(*options, {{"command", "calibrate"},
                               {"link", options->link},
                               {"force_n", options->force_n},
                               {"at_m", options->at_m}});
  });
}

void AddPluck(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<CommissionOptions>();
  CLI::App* verb = options->daemon.AddVerb(
      app, "pluck",
      "Check the wiring: compare the motion after a small torque on each joint with the model");
  options->daemon.AddTakeOver(verb);
  verb->footer(
      "Only from Armed; moves each joint by a few degrees, in open loop. Every drive, encoder and\n"
      "gauge with a wrong sign, scale or place is named. Exit code 0 if all are right.\n"
      "Example: flexarm arm && flexarm pluck");
  verb->callback([options, &exit] { exit.code = Run(*options, {{"command", "pluck"}}); });
}

void AddHome(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<CommissionOptions>();
  CLI::App* verb = options->daemon.AddVerb(
      app, "home", "Home a joint: move slowly to a limit switch, whose angle is known");
  options->daemon.AddTakeOver(verb);
  verb->add_option("joint", options->joint, "1 or 2")->required()->check(CLI::Range(1, 2));
  verb->add_option("side", options->side, "Which limit switch of the joint: low or high")
      ->required()
      ->check(CLI::IsMember({"low", "high"}));
  verb->footer(
      "Only from Armed, with the joint placed near the switch by hand. The joint moves slowly, by\n"
      "commissioning.home_travel_deg at most, until the switch opens, and then moves off it. The\n"
      "other switches trip as always, and so does this one if the arm stays on it.\n"
      "Example: flexarm home 1 low");
  verb->callback([options, &exit] {
    exit.code =
        Run(*options, {{"command", "home"}, {"joint", options->joint}, {"side", options->side}});
  });
}

}  // namespace

void RegisterCommission(CLI::App& app, Exit& exit) {
  AddTare(app, exit);
  AddZero(app, exit);
  AddCalibrate(app, exit);
  AddPluck(app, exit);
  AddHome(app, exit);
}

}  // namespace flexarm
