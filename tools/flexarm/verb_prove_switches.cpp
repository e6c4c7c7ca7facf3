#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <future>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tools/command_line/verbs.h"
#include "tools/daemon_client/daemon_client.h"
#include "tools/status/reply.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLongestProof_s =
    3'600.0;  // each step has a time of its own, which the daemon watches
constexpr auto kLook = std::chrono::milliseconds(100);

// "step 3 of 11: unplug the connector of ..", each text once.
void PrintStep(const Json& switches, std::string* shown) {
  if (!In(switches, "step").is_number()) return;
  const std::string text = "step " + FigureIn(switches, "step", 0) + " of " +
                           FigureIn(switches, "steps", 0) + ": " + TextIn(switches, "text");
  if (text == *shown) return;
  *shown = text;
  std::cout << text << '\n' << std::flush;
}

int Prove(const DaemonClient& daemon) {
  std::future<Json> answer = std::async(std::launch::async, [&daemon] {
    return daemon.Ask({{"command", "prove-switches"}}, kLongestProof_s);
  });
  std::string shown;
  while (answer.wait_for(kLook) != std::future_status::ready) {
    if (daemon.json) continue;
    PrintStep(In(daemon.Ask({{"command", "status"}}), "switches"), &shown);
  }
  const Json end = answer.get();
  if (FlagIn(end, "ok") && !daemon.json) {
    std::cout << "every switch is proved; run `flexarm reset`\n";
  }
  return daemon.Conclude(end);
}

}  // namespace

void RegisterProveSwitches(CLI::App& app, Exit& exit) {
  const auto daemon = std::make_shared<DaemonClient>();
  CLI::App* verb = daemon->AddVerb(
      app, "prove-switches", "Prove each switch of the rig: operate it, unplug it, press reset");
  daemon->AddTakeOver(verb);
  verb->footer(
      "With the relay open: Idle or Tripped. The program says what to do: operate each limit "
      "switch\n"
      "and the emergency stop by hand, unplug the connector of each once, press the reset button.\n"
      "An unplugged connector must read as open, or a cut wire would not trip. A step that sees\n"
      "nothing for 120 s ends the proof and is named. A wired rig runs only with this proof, "
      "which\n"
      "holds for safety.prove_days and for the lines of [hal.gpiod] as they are.\n"
      "Exit code 0 every switch is proved.\n"
      "Example: flexarm prove-switches");
  verb->callback([daemon, &exit] { exit.code = Prove(*daemon); });
}

}  // namespace flexarm
