#include <CLI/CLI.hpp>
#include <memory>

#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/flexarm/run_pictures.h"

namespace flexarm {
namespace {

struct PlotOptions {
  RunChoice runs;
  RunPictures pictures;
};

}  // namespace

void RegisterPlot(CLI::App& app, Exit&) {
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* verb = app.add_subcommand("plot", "Draw one run, or several runs in the same axes");
  options->runs.AddManyTo(verb);
  RefuseConfig(verb, kLogHasItsConfig);
  options->pictures.picture.AddTo(verb, "Picture to write, .png or .svg", false);
  verb->add_option("--html", options->pictures.page,
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
  verb->callback([options] { options->pictures.Draw(options->runs.Files()); });
}

}  // namespace flexarm
