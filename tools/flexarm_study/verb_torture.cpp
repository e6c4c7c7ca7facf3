#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "controller/files/external_json.h"
#include "controller/files/write_file.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/errors.h"
#include "controller/types/law_table.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/sweep_grid.h"
#include "tools/torture/campaign.h"
#include "tools/torture/fault_matrix.h"
#include "tools/torture/scenario_json.h"
#include "tools/torture/unsuited_law.h"

namespace flexarm {
namespace {

constexpr std::size_t kShown = 20;  // failures in the text
constexpr std::array kLaws = {"sobel", "sobel-thesis", "gain-scheduled", "lqg", "receding-horizon"};

struct TortureOptions {
  ConfigOptions config;
  GridOptions grid;
  std::vector<std::string> laws;  ///< empty: the config's, and those of kLaws that it allows
  std::string seeds = "1..1000";
  std::filesystem::path scenario;  ///< instead of seeds; empty: none
  bool minimise = false;
  bool matrix = false;
  OutputOptions page;
  bool json = false;
};

std::uint64_t SeedOf(const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw InputError("--seeds: found \"" + text + "\", expected whole numbers such as 1..1000");
  }
  return seed;
}

std::vector<std::uint64_t> SeedsOf(const TortureOptions& options) {
  const Shard shard = ParseShard(options.grid.shard);
  std::vector<std::uint64_t> seeds;
  std::size_t number = 0;
  for (const std::string& value : ParseValues(options.seeds)) {
    if (shard.Has(number++)) seeds.push_back(SeedOf(value));
  }
  return seeds;
}

void PrintSummary(const TortureSummary& summary) {
  std::printf("seeds %llu to %llu: %zu scenarios, %.0f s simulated, %zu tripped\n",
              static_cast<unsigned long long>(summary.first_seed),
              static_cast<unsigned long long>(summary.last_seed), summary.scenarios,
              summary.simulated_s, summary.tripped);
  std::printf("  %zu without a fault, %zu with one that had to be named in time\n", summary.clean,
              summary.observable);
  std::printf(
      "  %lld steps replayed; largest share of its limit while torque is allowed: torque "
      "%.2f, angle %.2f, rate %.2f, strain %.2f\n",
      static_cast<long long>(summary.replayed_steps), summary.peaks.torque_share,
      summary.peaks.angle_share, summary.peaks.rate_share, summary.peaks.strain_share);
  std::printf("  %zu broke a rule\n", summary.failures.size());
  for (std::size_t i = 0; i < std::min(summary.failures.size(), kShown); ++i) {
    const TortureFailure& failure = summary.failures[i];
    std::printf("seed %llu: %s at %.3f s: %s\n  %s\n",
                static_cast<unsigned long long>(failure.seed), failure.violation.rule.c_str(),
                static_cast<double>(failure.violation.at_ns) * 1e-9, failure.violation.what.c_str(),
                failure.text.c_str());
  }
}

int RunMatrix(const TortureOptions& options, const TorturedRigs& rigs, const TortureSpace& space,
              const RigConfig& config) {
  const OutputRules rules{.kind = "a fault matrix",
                          .mark = kMatrixMark,
                          .inputs = {options.config.file},
                          .overwrite = options.page.overwrite};
  if (options.page.given()) CheckOutput(options.page.file, rules);
  const std::vector<MatrixRow> rows =
      FaultMatrix(rigs, space, config, options.grid.jobs, ProgressBar("cells", MatrixCells(space)));
  if (options.page.given()) {
    WriteFile(options.page.file, MatrixMarkdown(rows, config), rules);
    ReportWritten(options.page.file);
  }
  const std::vector<std::string> broken = BrokenCells(rows);
  if (options.json) {
    std::cout << PrintedJson({{"cells", MatrixJson(rows)}, {"broken_rules", broken}}) << '\n';
  } else if (!options.page.given()) {
    std::cout << MatrixMarkdown(rows, config);
  }
  for (const std::string& line : broken) std::cerr << line << '\n';
  return broken.empty() ? Exit::kDone : Exit::kFailed;
}

RigConfig LoadWithLaw(const TortureOptions& options, const std::string& law) {
  ConfigOptions with_law = options.config;
  with_law.overrides.push_back("controller.name=" + law);
  return with_law.Load();
}

std::vector<std::string> LawsOf(const TortureOptions& options, const RigConfig& config) {
  if (!options.laws.empty()) return options.laws;
  std::vector<std::string> laws;
  for (const char* law : kLaws) {
    try {
      LoadWithLaw(options, law);
      laws.emplace_back(law);
    } catch (const ConfigError& error) {
      std::cerr << "without " << law << ", which this config does not allow: " << error.what()
                << '\n';
    }
  }
  const std::string own = LawOf(config.controller.kind).name;
  if (std::find(laws.begin(), laws.end(), own) == laws.end()) laws.push_back(own);
  return laws;
}

// Trips of a law that does not suit the arm say nothing of the safety chain. The config's own
// stays.
std::vector<std::string> WithoutUnsuited(const TortureOptions& options, const TorturedRigs& rigs,
                                         const RigConfig& config,
                                         const std::vector<std::string>& laws) {
  if (!options.laws.empty()) return laws;
  const TortureSpace space = SpaceOf(config, laws);
  const std::string own = LawOf(config.controller.kind).name;
  std::vector<std::string> why(laws.size());
  ParallelFor(
      laws.size(),
      [&](std::size_t i) {
        if (laws[i] != own) why[i] = WhyUnsuited(rigs, space, config, laws[i]);
      },
      {}, options.grid.jobs);
  std::vector<std::string> suited;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    if (why[i].empty()) {
      suited.push_back(laws[i]);
    } else {
      std::cerr << "without " << laws[i] << ", which does not suit this arm: " << why[i]
                << "; --laws takes it\n";
    }
  }
  return suited;
}

int Run(const TortureOptions& options) {
  const RigConfig config = options.config.Load();
  std::optional<TortureScenario> alone;
  if (!options.scenario.empty()) {
    alone = ReadScenario(options.scenario, static_cast<int>(config.sensors.strain.size()));
  }
  const std::vector<std::string> allowed =
      alone ? std::vector{alone->law} : LawsOf(options, config);
  const TorturedRigs rigs([&options](const std::string& law) { return LoadWithLaw(options, law); },
                          allowed);
  const TortureSpace space =
      SpaceOf(config, alone ? allowed : WithoutUnsuited(options, rigs, config, allowed));
  if (options.matrix) return RunMatrix(options, rigs, space, config);
  const std::vector<TortureScenario> scenarios =
      alone ? std::vector{*alone} : ScenariosOf(SeedsOf(options), space, config);
  const TortureSummary summary =
      RunTorture(rigs, scenarios, options.grid.jobs, ProgressBar("scenarios", scenarios.size()));
  nlohmann::ordered_json json = TortureJson(summary);
  json["laws"] = space.laws;
  json["build"] = BuildId();
  if (!summary.failures.empty() && options.minimise) {
    const TortureFailure& first = summary.failures.front();
    const auto broke =
        std::find_if(scenarios.begin(), scenarios.end(),
                     [&first](const TortureScenario& one) { return one.seed == first.seed; });
    const TortureScenario small = Minimised(rigs, *broke, first.violation.rule);
    json["minimised"] = Text(small);
    json["minimised_scenario"] = ScenarioJson(small);
  }
  if (options.json) {
    std::cout << PrintedJson(json) << '\n';
  } else {
    PrintSummary(summary);
    if (json.contains("minimised")) {
      std::cout << "the first, minimised: " << json["minimised"].get<std::string>()
                << "\nas a file for --scenario:\n"
                << PrintedJson(json["minimised_scenario"]) << '\n';
    }
  }
  return summary.failures.empty() ? Exit::kDone : Exit::kFailed;
}

}  // namespace

void RegisterTorture(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<TortureOptions>();
  CLI::App* verb = AddOtherVerb(app, "torture");
  options->config.AddTo(verb, true);
  verb->add_option("--seeds", options->seeds,
                   "Seeds of the scenarios, such as 1..1000 (default) or 4711")
      ->type_name("VALUES");
  verb->add_option(
          "--laws", options->laws,
          "Laws, separated by commas (default: sobel, sobel-thesis, gain-scheduled, lqg and "
          "receding-horizon, as far as the config allows them and they suit the arm, and the "
          "config's own)")
      ->type_name("NAMES")
      ->delimiter(',');
  options->grid.AddTo(verb);
  verb->get_option("--shard")->description("Only the I-th of N parts, 1 <= I <= N");
  verb->add_option("--scenario", options->scenario,
                   "Instead of seeds: the scenario of a file, which --minimise has printed")
      ->type_name("FILE")
      ->excludes("--seeds")
      ->excludes("--laws");
  verb->add_flag(
      "--minimise", options->minimise,
      "Search the smallest scenario that breaks the rule of the first failure, and print it");
  verb->add_flag("--matrix", options->matrix,
                 "Instead: every fault in every state with every law, on the nominal arm");
  verb->get_option("--matrix")->excludes("--scenario");
  options->page.AddTo(verb, "With --matrix: write the tables to this file, in Markdown", false);
  AddJson(verb, &options->json);
  verb->footer(
      "Each scenario is a session of the whole daemon on a simulated clock, with random faults,\n"
      "commands, arms and wake-ups of the threads. docs/torture.md lists the rules.\n"
      "Exit code 1: a rule was broken. A seed runs alone with --seeds SEED.\n"
      "Examples:\n"
      "  flexarm torture -c config/hil.toml\n"
      "  flexarm torture -c config/hil.toml --seeds 1..20000 --shard 1/4 --json\n"
      "  flexarm torture -c config/hil.toml --seeds 4711 --minimise\n"
      "  flexarm torture -c config/hil.toml --scenario small.json");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
