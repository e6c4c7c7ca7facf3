#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "controller/host/check_host.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

struct CheckHostOptions {
  ConfigOptions config;
  bool json = false;
};

const char* VerdictOf(bool ready) { return ready ? "ready" : "not-ready"; }

void PrintJson(const std::vector<HostCheck>& checks, bool ready) {
  nlohmann::ordered_json json;
  json["verdict"] = VerdictOf(ready);
  json["checks"] = nlohmann::ordered_json::array();
  for (const HostCheck& check : checks) {
    json["checks"].push_back({{"name", check.name},
                              {"ok", check.ok},
                              {"advice", check.advice},
                              {"value", check.value},
                              {"required", check.required},
                              {"remedy", check.remedy}});
  }
  std::cout << PrintedJson(json) << '\n';
}

void PrintText(const std::vector<HostCheck>& checks, bool ready) {
  for (const HostCheck& check : checks) {
    std::cout << (check.ok       ? "ok      "
                  : check.advice ? "advice  "
                                 : "FAILED  ")
              << std::left << std::setw(28) << check.name << ' ' << check.value << '\n';
    if (check.ok) continue;
    std::cout << "        required: " << check.required << "\n        remedy: " << check.remedy
              << '\n';
  }
  std::cout << "verdict: " << VerdictOf(ready) << '\n';
}

int CheckHostVerb(const CheckHostOptions& options) {
  const ConfigOptions& config = options.config;
  const bool has_rig = config.given() || !config.overrides.empty();  // Load refuses --set alone
  const std::vector<HostCheck> checks = has_rig ? CheckHost(config.Load()) : CheckHost();
  const bool ready = HostReady(checks);
  options.json ? PrintJson(checks, ready) : PrintText(checks, ready);
  return ready ? Exit::kDone : Exit::kFailed;
}

}  // namespace

void RegisterCheckHost(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<CheckHostOptions>();
  CLI::App* verb = app.add_subcommand(
      "check-host", "Check whether this machine is good enough to run a real rig");
  options->config.AddTo(verb, false);
  AddJson(verb, &options->json);
  verb->footer(
      "Prints each check with its value and, where it fails, what is required and the remedy:\n"
      "kernel, permissions, processors, clock; with a config also what its buses need. What\n"
      "cannot be read fails. Advice does not count for the verdict.\n"
      "Permissions and limits are those of the user who runs this; for those of the service:\n"
      "  systemd-run --pipe -p User=flexarm -p LimitRTPRIO=95 -p LimitMEMLOCK=infinity \\\n"
      "    flexarm check-host -c /etc/flexarm/rig.toml\n"
      "JSON: verdict (ready or not-ready), checks (name, ok, advice, value, required, remedy).\n"
      "Exit code 0 ready, 1 not ready.\n"
      "Example: flexarm check-host -c config/hil-wire.toml");
  verb->callback([options, &exit] { exit.code = CheckHostVerb(*options); });
}

}  // namespace flexarm
