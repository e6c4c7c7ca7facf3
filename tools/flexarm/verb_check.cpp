#include <CLI/CLI.hpp>
#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>

#include "controller/files/external_json.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/runs/conformance.h"

namespace flexarm {
namespace {

struct CheckOptions {
  std::filesystem::path run;
  bool json = false;
};

void PrintJson(const std::vector<ConformanceCheck>& checks, bool passed) {
  nlohmann::ordered_json json;
  json["passed"] = passed;
  json["checks"] = nlohmann::ordered_json::array();
  for (const ConformanceCheck& check : checks) {
    nlohmann::ordered_json& shown = json["checks"].emplace_back();
    shown = {{"name", check.name}, {"passed", check.passed}, {"detail", check.detail}};
    shown["time_s"] = nullptr;
    if (check.time_s) shown["time_s"] = *check.time_s;
    shown["record"] = nullptr;
    if (check.record) shown["record"] = *check.record;
  }
  std::cout << PrintedJson(json) << '\n';
}

int Check(const CheckOptions& options) {
  const std::vector<ConformanceCheck> checks = CheckConformance(LoadRun(options.run));
  const bool passed = std::all_of(checks.begin(), checks.end(),
                                  [](const ConformanceCheck& check) { return check.passed; });
  if (options.json) {
    PrintJson(checks, passed);
  } else {
    for (const ConformanceCheck& check : checks) {
      std::cout << (check.passed ? "ok      " : "FAILED  ") << std::left << std::setw(28)
                << check.name;
      if (check.time_s) std::cout << "at " << *check.time_s << " s, ";
      std::cout << check.detail << '\n';
    }
  }
  return passed ? Exit::kDone : Exit::kFailed;
}

}  // namespace

void RegisterCheck(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* verb =
      app.add_subcommand("check", "Check a run log against the safety and consistency rules");
  verb->add_option("run", options->run, "Run log")->required()->type_name("RUN");
  AddJson(verb, &options->json);
  RefuseConfig(verb, kLogHasItsConfig);
  verb->footer(
      "Rules: no missing tick, increasing time, torque and slew limits, torque only in states\n"
      "that allow it, every safety record as the table of transitions requires, trips latched,\n"
      "Running only if it was granted, values as they were written (digest), run ended in order.\n"
      "Prints ok or FAILED for each rule, and of the first violation its time, its record\n"
      "and what the rule requires. Exit code 1 if a rule is broken.\n"
      "Example: flexarm check runs/today.flexarm");
  verb->callback([options, &exit] { exit.code = Check(*options); });
}

}  // namespace flexarm
