#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "controller/files/input_error.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/plot_script.h"

namespace flexarm {
namespace {

struct PlotOptions {
  std::vector<std::filesystem::path> runs;
  OutputOptions output;
};

void Plot(const PlotOptions& options) {
  const OutputRules rules = PictureRules(options.runs, options.output.overwrite);
  CheckPicture(options.output.file, rules);
  std::vector<PlotRun> runs;
  for (const auto& file : options.runs) {
    runs.push_back(PlotDataOf(LoadRun(file)));
    if (runs.back().sample.empty()) {
      throw InputError(file.string() + ": has no ticks; expected a run with at least one");
    }
  }
  DrawPicture(PlotScript(runs, options.output.file), options.output.file, rules);
  ReportWritten(options.output.file);
}

}  // namespace

void RegisterPlot(CLI::App& app, Exit&) {
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* verb = app.add_subcommand("plot", "Draw one run, or several runs in the same axes");
  verb->add_option("runs", options->runs, "Run logs")->required()->type_name("RUN..");
  options->output.AddTo(verb, "Picture to write, .png or .svg", true);
  verb->footer(
      "The picture shows the joint angles with their references, the torques and the strains at "
      "the\n"
      "roots of the links with their limits, the tip deflections, the tip's distance from its\n"
      "target, the payload estimate with its sigma, the safety states with trips and events, and\n"
      "the arm seen from above in up to six moves. It draws any number of moves, and of a long "
      "run\n"
      "the least and the greatest value of each part of the time axis: no peak is lost.\n"
      "Example: flexarm plot runs/today.flexarm runs/yesterday.flexarm -o compare.png");
  verb->callback([options] { Plot(*options); });
}

}  // namespace flexarm
