#include "tools/torture/campaign.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "controller/runlog/errors.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

void Add(const TortureScenario& scenario, const TortureOutcome& outcome, TortureSummary* summary) {
  ++summary->scenarios;
  if (scenario.is_clean()) ++summary->clean;
  if (outcome.observable_ns != INT64_MAX) ++summary->observable;
  if (outcome.cause != TripCause::kNone) {
    ++summary->tripped;
    ++summary->causes[ToString(outcome.cause)];
  }
  summary->simulated_s += static_cast<double>(outcome.simulated_ns) * 1e-9;
  summary->replayed_steps += outcome.records;
  Raise(outcome.peaks, &summary->peaks);
  if (outcome.violations.empty()) return;
  ++summary->rules[outcome.violations.front().rule];
  summary->failures.push_back(
      {.seed = scenario.seed, .violation = outcome.violations.front(), .text = Text(scenario)});
}

}  // namespace

std::vector<TortureScenario> ScenariosOf(const std::vector<std::uint64_t>& seeds,
                                         const TortureSpace& space, const RigConfig& config) {
  if (seeds.empty()) throw InputError("no scenario: expected at least one seed");
  std::vector<TortureScenario> scenarios;
  for (const std::uint64_t seed : seeds) scenarios.push_back(ScenarioOf(seed, space, config));
  return scenarios;
}

TortureSummary RunTorture(const TorturedRigs& rigs, const std::vector<TortureScenario>& scenarios,
                          std::size_t jobs, const std::function<void(std::size_t)>& progress) {
  std::vector<TortureOutcome> outcomes(scenarios.size());
  ParallelFor(
      scenarios.size(),
      [&](std::size_t i) {
        outcomes[i] = RunScenario(rigs, scenarios[i]);
        outcomes[i].tip_m = {};  // 10 kB of each session, of which there may be a million
      },
      progress, jobs);
  TortureSummary summary{.first_seed = scenarios.front().seed, .last_seed = scenarios.back().seed};
  for (std::size_t i = 0; i < scenarios.size(); ++i) Add(scenarios[i], outcomes[i], &summary);
  return summary;
}

nlohmann::ordered_json TortureJson(const TortureSummary& summary) {
  nlohmann::ordered_json failures = nlohmann::ordered_json::array();
  for (const TortureFailure& failure : summary.failures) {
    failures.push_back({{"seed", failure.seed},
                        {"rule", failure.violation.rule},
                        {"at_s", static_cast<double>(failure.violation.at_ns) * 1e-9},
                        {"what", failure.violation.what},
                        {"scenario", failure.text}});
  }
  return {{"first_seed", summary.first_seed},
          {"last_seed", summary.last_seed},
          {"scenarios", summary.scenarios},
          {"without_fault", summary.clean},
          {"observable", summary.observable},
          {"tripped", summary.tripped},
          {"simulated_s", summary.simulated_s},
          {"replayed_steps", summary.replayed_steps},
          {"peak_torque_share", summary.peaks.torque_share},
          {"peak_angle_share", summary.peaks.angle_share},
          {"peak_rate_share", summary.peaks.rate_share},
          {"peak_strain_share", summary.peaks.strain_share},
          {"causes", summary.causes},
          {"broken_rules", summary.rules},
          {"failures", failures}};
}

}  // namespace flexarm
