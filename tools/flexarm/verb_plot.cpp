#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "controller/files/input_error.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/plot_script.h"
#include "tools/plot/run_page.h"

namespace flexarm {
namespace {

struct PlotOptions {
  RunChoice runs;
  std::filesystem::path page;
  OutputOptions output;
};

std::vector<LoadedRun> LoadRuns(const std::vector<std::filesystem::path>& files) {
  std::vector<LoadedRun> runs;
  for (const auto& file : files) {
    runs.push_back(LoadRun(file));
    if (runs.back().contents.tick.empty()) {
      throw InputError(file.string() + ": has no ticks; expected a run with at least one");
    }
  }
  return runs;
}

void Plot(const PlotOptions& options) {
  const std::vector<std::filesystem::path> files = options.runs.Files();
  const OutputRules picture = PictureRules(files, options.output.overwrite);
  const OutputRules page = options.output.Rules("a page of runs", kRunPageMark, files);
  if (!options.output.given() && options.page.empty()) {
    throw InputError(
        "plot: nothing to write; expected -o FILE.png, -o FILE.svg or --html FILE.html");
  }
  if (options.output.given()) CheckPicture(options.output.file, picture);
  if (!options.page.empty()) CheckOutput(options.page, page);
  const std::vector<LoadedRun> runs = LoadRuns(files);
  if (options.output.given()) {
    std::vector<PlotRun> plots;
    for (const LoadedRun& run : runs) plots.push_back(PlotDataOf(run));
    DrawPicture(PlotScript(plots, options.output.file), options.output.file, picture);
    ReportWritten(options.output.file);
  }
  if (!options.page.empty()) {
    WriteFile(options.page, RunPage(runs), page);
    ReportWritten(options.page);
  }
}

}  // namespace

void RegisterPlot(CLI::App& app, Exit&) {
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* verb = app.add_subcommand("plot", "Draw one run, or several runs in the same axes");
  options->runs.AddManyTo(verb);
  options->output.AddTo(verb, "Picture to write, .png or .svg", false);
  verb->add_option("--html", options->page,
                   "Page to write, one file that needs no network: values, zoom, the arm animated")
      ->type_name("FILE");
  verb->footer(
      "The picture shows the joint angles with their references, the torques and the strains at "
      "the\n"
      "roots of the links with their limits, the tip deflections, the tip's distance from its\n"
      "target, the payload estimate with its sigma, the safety states with trips and events, and\n"
      "the arm seen from above in up to six moves. It draws any number of moves, and of a long "
      "run\n"
      "the least and the greatest value of each part of the time axis: no peak is lost.\n"
      "Example: flexarm plot runs/today.flexarm --html today.html\n"
      "Example: flexarm plot --last -o last.png");
  verb->callback([options] { Plot(*options); });
}

}  // namespace flexarm
