#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "controller/files/write_file.h"
#include "tools/benchmark/benchmark.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

struct BenchmarkOptions {
  ConfigOptions config;
  GridOptions grid;
  std::string table = ToString(BenchmarkKind::kCommands), laws, seeds;
  std::filesystem::path output, page;
  bool overwrite = false;
  bool json = false;
};

void Run(const BenchmarkOptions& options) {
  const RigConfig config = options.config.Load();
  const BenchmarkSet set = BenchmarkSetOf(BenchmarkKindNamed(options.table), config,
                                          ExperimentsFolder(options.config.file, kBenchmarkFile));
  const SweepPlan plan = BenchmarkPlan(config, set, options.laws, options.seeds);
  const OutputRules page{.kind = "a benchmark's page",
                         .mark = kBenchmarkPageMark,
                         .inputs = {options.config.file, options.output},
                         .overwrite = options.overwrite};
  if (!options.page.empty()) CheckOutput(options.page, page);
  SweepFile file = SweepFile::Resume(options.output, IdentityOf(plan));
  const std::vector<std::size_t> points = PointsToRun(&file, ParseShard(options.grid.shard));
  RunSweep(plan, points, &file, options.grid.jobs, ProgressBar("runs", points.size()));
  const std::size_t missing = PointsToRun(&file, {}).size();
  const BenchmarkTable table = TableOf(set, plan, file.Rows());
  if (!options.page.empty()) {
    WriteFile(options.page, kBenchmarkPageMark + ("\n\n" + BenchmarkMarkdown(table)), page);
    ReportWritten(options.page);
  }
  if (options.json) {
    nlohmann::ordered_json json = BenchmarkJson(table);
    json["missing"] = missing;
    json["results"] = options.output.string();
    std::cout << PrintedJson(json) << '\n';
  } else {
    std::cout << BenchmarkMarkdown(table);
    if (missing > 0) std::cout << "\n" << missing << " runs belong to other shards\n";
  }
}

}  // namespace

void RegisterBenchmark(CLI::App& app, Exit&) {
  const auto options = std::make_shared<BenchmarkOptions>();
  CLI::App* verb = AddOtherVerb(app, "benchmark");
  options->config.AddTo(verb, true);
  verb->add_option("--table", options->table,
                   "commands (default): the commands of config/experiments\n"
                   "moves: random smooth moves with the payloads of the rig, also for the laws "
                   "that estimate the payload\n"
                   "limits: the same moves for those laws, with encoders, gauges and friction "
                   "made ideal\n"
                   "fast: moves as short as each law makes them, and their time over the bound of "
                   "a rigid arm")
      ->type_name("NAME");
  verb->add_option("--laws", options->laws, "Only these laws, by name, separated by commas")
      ->type_name("NAMES");
  verb->add_option("--seeds", options->seeds,
                   "Seeds of the noise and of random moves (default: 1..3; on moves 4001..4010, "
                   "fast 4101..4110)")
      ->type_name("VALUES");
  options->grid.AddTo(verb);
  verb->add_option("--page", options->page, "Also write the tables to this file, in Markdown")
      ->type_name("FILE");
  verb->add_flag("--overwrite", options->overwrite,
                 "Replace an existing file of --page, whatever it is");
  AddOutput(verb, &options->output, "Results, a SQLite file; runs that it holds are not repeated");
  AddJson(verb, &options->json);
  verb->footer(
      "The score of a law is the share of the rests, in percent, in which the tip is at rest,\n"
      "mean over all scenarios; a run that trips scores 0. docs/benchmark.md gives the rules.\n"
      "Example: flexarm benchmark -c config/hil.toml -o benchmark.sqlite");
  verb->callback([options] { Run(*options); });
}

}  // namespace flexarm
