#include "tools/benchmark/benchmark_set.h"

#include <algorithm>
#include <array>

#include "controller/runlog/errors.h"
#include "controller/types/law_table.h"
#include "tools/sweep/sweep.h"

namespace flexarm {
namespace {

constexpr std::array kKinds = {BenchmarkKind::kCommands, BenchmarkKind::kMoves,
                               BenchmarkKind::kLimits, BenchmarkKind::kFast};

// No law was tried on these seeds during its development, tests included.
constexpr const char* kMoveSeeds = "4001..4010";
constexpr const char* kFastSeeds = "4101..4110";

// One line, without the option in which the problem lies.
std::string WhyOf(const ConfigError& error) {
  std::string why;
  for (const ConfigProblem& problem : error.problems()) {
    why += (why.empty() ? "" : "; ") + problem.key + " = " + problem.value + ": " + problem.rule;
  }
  return why;
}

void AddTo(std::vector<std::string>* laws, const std::vector<std::string>& others) {
  laws->insert(laws->end(), others.begin(), others.end());
}

void LeaveOutLaws(const RigConfig& config, BenchmarkSet* set) {
  std::erase_if(set->laws, [&](const std::string& law) {
    try {
      WithLaw(config, law);
      return false;
    } catch (const ConfigError& error) {
      set->left_out.push_back({.name = law, .why = WhyOf(error)});
      return true;
    }
  });
}

void LeaveOutScenarios(const RigConfig& config, BenchmarkSet* set) {
  std::erase_if(set->scenarios, [&](const Scenario& scenario) {
    SweepPlan plan{.config = config,
                   .experiment = scenario.experiment,
                   .grid = SweepGrid(
                       {{.target = AxisTarget::kScenario, .key = {}, .values = {scenario.name}}}),
                   .scenarios = {scenario}};
    try {
      CheckPlan(plan);
      return false;
    } catch (const ConfigError& error) {
      set->left_out.push_back({.name = scenario.name, .why = WhyOf(error)});
      return true;
    }
  });
}

}  // namespace

const char* ToString(BenchmarkKind kind) {
  switch (kind) {
    case BenchmarkKind::kCommands:
      return "commands";
    case BenchmarkKind::kMoves:
      return "moves";
    case BenchmarkKind::kLimits:
      return "limits";
    case BenchmarkKind::kFast:
      return "fast";
  }
  return "?";
}

BenchmarkKind BenchmarkKindNamed(const std::string& name) {
  std::string known;
  for (const BenchmarkKind kind : kKinds) {
    if (name == ToString(kind)) return kind;
    known += std::string(known.empty() ? "" : ", ") + ToString(kind);
  }
  throw InputError("--table " + name + ": expected one of " + known);
}

std::vector<std::string> CommandLaws() {
  return LawNames([](const LawRow& law) { return !law.is_scheduled; });
}

std::vector<std::string> PayloadLaws() {
  return LawNames([](const LawRow& law) { return law.is_scheduled; });
}

BenchmarkSet BenchmarkSetOf(BenchmarkKind kind, const RigConfig& config,
                            const std::filesystem::path& experiments) {
  BenchmarkSet set{.kind = kind, .scenarios = {}, .laws = PayloadLaws(), .seeds = kMoveSeeds};
  switch (kind) {
    case BenchmarkKind::kCommands:
      set.scenarios = CommandScenarios(config, experiments);
      set.laws = CommandLaws();
      set.seeds = "1..3";
      break;
    case BenchmarkKind::kMoves:
      set.scenarios = MoveScenarios(config);
      AddTo(&set.laws, CommandLaws());
      break;
    case BenchmarkKind::kLimits:
      set.scenarios = LimitScenarios(config);
      break;
    case BenchmarkKind::kFast:
      set.scenarios = FastScenarios(config);
      AddTo(&set.laws, CommandLaws());
      set.seeds = kFastSeeds;
      break;
  }
  LeaveOutLaws(config, &set);
  LeaveOutScenarios(config, &set);
  return set;
}

BenchmarkSet Only(BenchmarkSet set, const std::vector<std::string>& scenarios) {
  std::erase_if(set.scenarios, [&scenarios](const Scenario& scenario) {
    return std::find(scenarios.begin(), scenarios.end(), scenario.name) == scenarios.end();
  });
  return set;
}

}  // namespace flexarm
