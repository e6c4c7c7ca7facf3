#include "tools/torture/campaign.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "controller/runlog/errors.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

void Raise(const Peaks& of_run, Peaks* most) {
  most->torque_share = std::max(most->torque_share, of_run.torque_share);
  most->angle_share = std::max(most->angle_share, of_run.angle_share);
  most->rate_share = std::max(most->rate_share, of_run.rate_share);
  most->strain_share = std::max(most->strain_share, of_run.strain_share);
}

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

TortureSummary RunTorture(const TorturedRigs& rigs, const TortureSpace& space,
                          const RigConfig& config, const std::vector<std::uint64_t>& seeds,
                          std::size_t jobs, const std::function<void(std::size_t)>& progress) {
  if (seeds.empty()) throw InputError("no scenario: expected at least one seed");
  std::vector<TortureScenario> scenarios(seeds.size());
  std::vector<TortureOutcome> outcomes(seeds.size());
  ParallelFor(
      seeds.size(),
      [&](std::size_t i) {
        scenarios[i] = ScenarioOf(seeds[i], space, config);
        outcomes[i] = RunScenario(rigs, scenarios[i]);
        outcomes[i].tip_m = {};  // 10 kB of each session, of which there may be a million
      },
      progress, jobs);
  TortureSummary summary{.first_seed = seeds.front(), .last_seed = seeds.back()};
  for (std::size_t i = 0; i < seeds.size(); ++i) Add(scenarios[i], outcomes[i], &summary);
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
