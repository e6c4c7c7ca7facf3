#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/benchmark/benchmark_set.h"
#include "tools/benchmark/rest_figures.h"
#include "tools/sweep/sweep.h"
#include "tools/sweep/sweep_summary.h"

namespace flexarm {

/// Every law in every scenario with every seed, as a sweep.
/// @param laws   names with commas between; empty: the set's
/// @param seeds  empty: the set's
/// @throws InputError  no such law, none that the rig permits, no such seeds
SweepPlan BenchmarkPlan(const RigConfig& config, const BenchmarkSet& set,
                        const std::string& laws = {}, const std::string& seeds = {});

/// Results of one law in one scenario.
struct BenchmarkCell {
  SweepGroup group;   ///< over the seeds
  RestFigures rests;  ///< of the same runs
  /// 100 times the share of the shortest rest in which the tip is settled, mean over the seeds;
  /// a run that did not complete, or with a rest that is not settled, counts 0.
  double score = 0.0;
};

/// The results in one table.
struct BenchmarkTable {
  BenchmarkKind kind;
  std::vector<std::string> laws;
  std::vector<Scenario> scenarios;
  std::vector<std::vector<BenchmarkCell>> cell;  ///< [law][scenario]
  std::vector<LeftOut> left_out{};

  double Score(std::size_t law) const;               ///< mean over the scenarios
  std::size_t WorstScenario(std::size_t law) const;  ///< that with the lowest score
  std::size_t Completed(std::size_t law) const;      ///< runs
  std::size_t Runs(std::size_t law) const;
};

/// @param plan  of this set
/// @param rows  of the plan; points may be missing
BenchmarkTable TableOf(const BenchmarkSet& set, const SweepPlan& plan,
                       const std::vector<SweepRow>& rows);

nlohmann::ordered_json BenchmarkJson(const BenchmarkTable& table);

/// A table as text.
struct TextTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// A table with its introductory sentence.
struct TablePart {
  std::string about;
  TextTable table;
};

/// First line of a page file, by which flexarm knows its own.
inline constexpr const char* kBenchmarkPageMark = "<!-- flexarm benchmark -->";

/// The tables that present the results, by the kind of the benchmark table.
std::vector<TablePart> TableParts(const BenchmarkTable& table);
/// The same in Markdown.
std::string BenchmarkMarkdown(const BenchmarkTable& table);

}  // namespace flexarm
