#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "controller/files/input_error.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/plot_script.h"

namespace flexarm {
namespace {

struct PlotOptions {
  RunChoice runs;
  OutputOptions output;
};

void Plot(const PlotOptions& options) {
  const std::vector<std::filesystem::path> files = options.runs.Files();
  const OutputRules rules = PictureRules(files, options.output.overwrite);
  CheckPicture(options.output.file, rules);
  std::vector<PlotRun> runs;
  for (const auto& file : files) {
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
  options->runs.AddManyTo(verb);
  options->output.AddTo(verb, "Picture to write, .png or .svg", true);
  verb->footer(
      "The picture shows the joint angles with their references, the asked and the applied\n"
      "torques, the tip deflections, the tip's distance from its resting place, the safety state,\n"
      "and the arm seen from above.\n"
      "Examples: flexarm plot runs/today.flexarm runs/yesterday.flexarm -o compare.png\n"
      "          flexarm plot --last -o last.png");
  verb->callback([options] { Plot(*options); });
}

}  // namespace flexarm
