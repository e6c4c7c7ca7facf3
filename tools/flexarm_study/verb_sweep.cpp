#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>

#include "controller/files/external_json.h"
#include "controller/files/write_file.h"
#include "controller/runlog/errors.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/plant_variant.h"
#include "tools/sweep/sweep.h"
#include "tools/sweep/sweep_summary.h"

namespace flexarm {
namespace {

constexpr const char* kResultsHaveTheirConfig = "the results have the config of their sweep";
constexpr std::size_t kMissingNamed = 10;  // points that a message lists

struct RunOptions {
  ConfigOptions config;
  std::filesystem::path experiment;
  std::vector<std::string> over, plant;
  GridOptions grid;
  std::string variants, payloads, seeds;
  std::filesystem::path output;
  bool json = false;
};

struct MergeOptions {
  std::vector<std::filesystem::path> parts;
  std::filesystem::path output;
  bool json = false;
};

struct ShowOptions {
  std::filesystem::path results;
  std::string by;
  OutputOptions output;
  bool json = false;
};

void AddNamed(AxisTarget target, const std::string& values, std::vector<SweepAxis>* axes) {
  if (values.empty()) return;
  axes->push_back({.target = target, .key = {}, .values = ParseValues(values)});
}

// The seed varies fastest, so that every shard has runs of every group.
std::vector<SweepAxis> AxesOf(const RunOptions& options) {
  std::vector<SweepAxis> axes;
  for (const std::string& text : options.over) {
    axes.push_back(ParseAxis(AxisTarget::kConfig, text));
  }
  for (const std::string& text : options.plant) {
    axes.push_back(ParseAxis(AxisTarget::kPlant, text));
  }
  AddNamed(AxisTarget::kVariant, options.variants, &axes);
  AddNamed(AxisTarget::kPayload, options.payloads, &axes);
  AddNamed(AxisTarget::kSeed, options.seeds, &axes);
  if (axes.empty()) {
    throw InputError("nothing to sweep; expected --over, --plant, --variants, --payload-kg or " +
                     std::string("--seeds"));
  }
  return axes;
}

std::size_t FailedOf(SweepFile* file, const Shard& shard) {
  std::size_t failed = 0;
  for (const SweepRow& row : file->Rows()) {
    if (shard.Has(row.point) && !row.completed) ++failed;
  }
  return failed;
}

void Run(const RunOptions& options) {
  const RigConfig config = options.config.Load();
  const ChosenExperiment chosen = ChooseExperiment(options.experiment, options.config.file, config);
  const SweepPlan plan{
      .config = config, .experiment = chosen.experiment, .grid = SweepGrid(AxesOf(options))};
  const Shard shard = ParseShard(options.grid.shard);
  CheckPlan(plan);
  SweepFile file = SweepFile::Resume(options.output, IdentityOf(plan));
  const std::vector<std::size_t> points = PointsToRun(&file, shard);
  std::size_t of_shard = 0;
  for (std::size_t point = 0; point < plan.grid.size(); ++point) {
    if (shard.Has(point)) ++of_shard;
  }
  RunSweep(plan, points, &file, options.grid.jobs, ProgressBar("runs", points.size()));
  const std::size_t failed = FailedOf(&file, shard);
  if (options.json) {
    nlohmann::ordered_json json;
    json["points"] = plan.grid.size();
    json["points_of_shard"] = of_shard;
    json["there_already"] = of_shard - points.size();
    json["run_now"] = points.size();
    json["not_completed"] = failed;
    json["results"] = options.output.string();
    std::cout << PrintedJson(json) << '\n';
  } else {
    std::printf("%zu runs made, %zu were in the file; %zu did not complete (tripped or refused)\n",
                points.size(), of_shard - points.size(), failed);
    std::printf("Next: flexarm sweep show %s\n", options.output.c_str());
  }
}

void PrintMissing(const std::vector<std::size_t>& missing, const SweepGrid& grid) {
  std::printf("missing: %zu of %zu points\n", missing.size(), grid.size());
  for (std::size_t i = 0; i < std::min(missing.size(), kMissingNamed); ++i) {
    const std::vector<std::string> values = grid.Values(missing[i]);
    std::printf("  point %zu:", missing[i]);
    for (std::size_t axis = 0; axis < values.size(); ++axis) {
      std::printf(" %s=%s", grid.axes()[axis].Column().c_str(), values[axis].c_str());
    }
    std::printf("\n");
  }
  if (missing.size() > kMissingNamed) std::printf("  ..\n");
}

int Merge(const MergeOptions& options) {
  const std::vector<std::size_t> missing = MergeSweeps(options.parts, options.output);
  const SweepGrid grid = SweepFile::Open(options.output).grid();
  if (options.json) {
    nlohmann::ordered_json json;
    json["points"] = grid.size();
    json["done"] = grid.size() - missing.size();
    json["missing"] = missing;
    json["results"] = options.output.string();
    std::cout << PrintedJson(json) << '\n';
  } else {
    PrintMissing(missing, grid);
  }
  return missing.empty() ? Exit::kDone : Exit::kFailed;
}

void Show(const ShowOptions& options) {
  const std::filesystem::path& output = options.output.file;
  const bool csv = output.extension() == ".csv";
  const OutputRules rules = csv ? SummaryCsvRules({options.results}, options.output.overwrite)
                                : PictureRules({options.results}, options.output.overwrite);
  if (csv) CheckOutput(output, rules);
  if (options.output.given() && !csv) CheckPicture(output, rules);
  SweepFile file = SweepFile::Open(options.results);
  const SweepSummary summary = Summarise(&file, options.by);
  if (csv) {
    WriteSummaryCsv(summary, output, rules);
  } else if (options.output.given()) {
    DrawSummary(summary, output, rules);
  }
  if (options.json) {
    std::cout << PrintedJson(SummaryJson(summary)) << '\n';
  } else if (!options.output.given()) {
    PrintSummary(summary);
  }
}

void RegisterMerge(CLI::App* sweep, Exit& exit) {
  const auto options = std::make_shared<MergeOptions>();
  CLI::App* verb =
      sweep->add_subcommand("merge", "Merge the results of the shards of one sweep into one file");
  RefuseConfig(verb, kResultsHaveTheirConfig);
  verb->add_option("parts", options->parts, "Result files of the shards")
      ->required()
      ->type_name("FILE");
  AddOutput(verb, &options->output, "Write all results here (must not exist)");
  AddJson(verb, &options->json);
  verb->footer(
      "Exit code 1 if points are missing: they are named. The sweep's own command with -o on the\n"
      "merged file runs them.\n"
      "Example: flexarm sweep merge part-1.sqlite part-2.sqlite -o all.sqlite");
  verb->callback([options, &exit] { exit.code = Merge(*options); });
}

void RegisterShow(CLI::App* sweep) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* verb =
      sweep->add_subcommand("show", "Show the medians over the seeds as a table or a picture");
  RefuseConfig(verb, kResultsHaveTheirConfig);
  verb->add_option("results", options->results, "Results of a sweep")
      ->required()
      ->type_name("FILE");
  verb->add_option("--by", options->by,
                   "Axis to compare along: it varies fastest in the table and is the x axis of the "
                   "picture (default: the first with more than one value)")
      ->type_name("KEY");
  options->output.AddTo(verb, "Write a .png, .svg or .csv instead of text", false);
  AddJson(verb, &options->json);
  verb->footer(
      "Medians are over the runs that completed; the column beside them says how many did.\n"
      "Example: flexarm sweep show alpha.sqlite --by controller.alpha -o alpha.png");
  verb->callback([options] { Show(*options); });
}

void AddAxisOptions(CLI::App* verb, RunOptions* options) {
  verb->add_option("--over", options->over,
                   "Values of a config key, for the simulated rig AND the controller designed for "
                   "it; repeatable")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  verb->add_option(
          "--plant", options->plant,
          "Values of a config key for the simulated rig ALONE (arm, link1, link2, joint1, "
          "joint2, sensors, sim): the controller is still designed for the config's; repeatable")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  std::string variants = "Plants by name, for the simulated rig ALONE:";
  for (const PlantVariant& variant : PlantVariants()) {
    variants += std::string("\n") + variant.name + ": " + variant.what;
  }
  verb->add_option("--variants", options->variants, variants)->type_name("NAMES");
  verb->add_option("--payload-kg", options->payloads,
                   "Payloads of the simulated rig, kg; the controller is designed for the config's")
      ->type_name("VALUES");
  verb->add_option("--seeds", options->seeds, "Seeds of the measurement noise, such as 1..11")
      ->type_name("VALUES");
}

}  // namespace

void RegisterSweep(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<RunOptions>();
  CLI::App* verb = AddOtherVerb(app, "sweep");
  options->config.AddTo(verb, false);
  verb->add_option("--experiment", options->experiment,
                   "Experiment, a TOML file (default: experiments/square-30deg.toml beside the "
                   "config or shipped, or moves.toml for a law that follows moves only; slower or "
                   "smaller if the "
                   "rig needs it)")
      ->type_name("FILE");
  AddAxisOptions(verb, options.get());
  options->grid.AddTo(verb);
  verb->add_option("-o,--output", options->output,
                   "Results, a SQLite file; runs that it holds are not repeated")
      ->type_name("FILE");
  AddJson(verb, &options->json);
  verb->footer(
      "VALUES: v1,v2,..   or FROM:STEP:TO, both ends included   or FIRST..LAST, whole numbers\n"
      "Every combination runs once. To continue an interrupted sweep, repeat the same command.\n"
      "A run that trips, or whose design fails, is a result too. See docs/sweep.md.\n"
      "Examples:\n"
      "  flexarm sweep -c config/hil.toml --over controller.alpha=0:0.5:5 --seeds 1..11 -o "
      "alpha.sqlite\n"
      "  flexarm sweep show alpha.sqlite\n"
      "  flexarm sweep -c config/hil.toml --payload-kg 0,0.1,0.2 --variants nominal,backlash -o "
      "v.sqlite\n"
      "  flexarm sweep -c config/hil.toml --over sim.transport_delay_ms=0,10,20 --shard 2/8 -o "
      "part-2.sqlite");
  verb->require_subcommand(0, 1);
  RegisterMerge(verb, exit);
  RegisterShow(verb);
  verb->parse_complete_callback([options, verb] {  // before those of the verbs below
    if (verb->get_subcommands().empty()) return;
    if (!options->config.given() && options->config.overrides.empty()) return;
    throw InputError("sweep " + verb->get_subcommands().front()->get_name() +
                     ": --config and --set have no effect here: " + kResultsHaveTheirConfig);
  });
  verb->callback([options, verb] {
    if (!verb->get_subcommands().empty()) return;
    if (!options->config.given()) throw CLI::RequiredError("--config");
    if (options->output.empty()) throw CLI::RequiredError("--output");
    Run(*options);
  });
}

}  // namespace flexarm
