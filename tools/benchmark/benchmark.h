#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/sweep/sweep.h"
#include "tools/sweep/sweep_summary.h"

namespace flexarm {

/// The situations of the benchmark, in the order of its tables (docs/benchmark.md).
/// @param experiments  folder with benchmark-square.toml and the others
/// @throws ConfigError  one of them is missing or wrong
std::vector<Scenario> BenchmarkScenarios(const std::filesystem::path& experiments);

/// The laws that it compares, by their names in the config.
std::vector<std::string> BenchmarkLaws();

/// Every law in every scenario with every seed, as a sweep.
/// @param laws   empty: all
/// @param seeds  values of a seed axis, such as "1..3"
/// @throws InputError  no such law, no such seeds
SweepPlan BenchmarkPlan(const Config& config, const std::filesystem::path& experiments,
                        const std::string& laws, const std::string& seeds);

/// What a law did in a scenario.
struct BenchmarkCell {
  SweepGroup group;  ///< over the seeds
  /// 100 times the share of the shortest rest in which the tip really rests, mean over the seeds: 0
  /// for a run that did not complete or never settled.
  double score = 0.0;
};

/// The results in one table.
struct BenchmarkTable {
  std::vector<std::string> laws;
  std::vector<Scenario> scenarios;
  std::vector<std::vector<BenchmarkCell>> cell;  ///< [law][scenario]

  double Score(std::size_t law) const;               ///< mean over the scenarios
  std::size_t WorstScenario(std::size_t law) const;  ///< that with the lowest score
  std::size_t Completed(std::size_t law) const;      ///< runs
  std::size_t Runs(std::size_t law) const;
};

/// @param rows  of the plan, as many as there are
BenchmarkTable TableOf(const SweepPlan& plan, const std::vector<SweepRow>& rows);

nlohmann::ordered_json BenchmarkJson(const BenchmarkTable& table);

/// A table for people.
struct TextTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// A row a law: score, worst scenario, and the figures of the nominal one.
TextTable LawTable(const BenchmarkTable& table);
/// A row a scenario: the settling time of every law.
TextTable ScenarioTable(const BenchmarkTable& table);

/// Both, in Markdown.
std::string BenchmarkMarkdown(const BenchmarkTable& table);

}  // namespace flexarm
