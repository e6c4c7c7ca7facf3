#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>

#include "controller/files/external_json.h"
#include "controller/files/write_file.h"
#include "controller/runlog/errors.h"
#include "model/units.h"
#include "tools/analysis/reduction_figures.h"
#include "tools/analysis/reduction_report.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

struct ReduceOptions {
  ConfigOptions config;
  std::filesystem::path system;
  int modes = 10;
  double theta2_deg = 0.0, theta1_rate_rad_s = 0.0, theta2_rate_rad_s = 0.0;
  ReductionOptions reduction;
  bool with_grid = false;
  ReductionGrid grid;
  bool json = false;
  OutputOptions output;
};

void Check(const ReduceOptions& options) {
  if (options.system.empty() == !options.config.given()) {
    throw InputError("analyze reduce: expected either --config FILE or --system FILE");
  }
  if (!options.system.empty() && !options.config.overrides.empty()) {
    throw InputError(
        "analyze reduce: --set has no effect on a --system: it changes a config; change the file");
  }
  if (!options.system.empty() && (options.with_grid || options.output.given())) {
    throw InputError("analyze reduce: --grid and --output are for an arm: they need --config");
  }
  if (!(options.grid.theta2_deg[0] < options.grid.theta2_deg[1])) {
    throw InputError("analyze reduce: --grid-theta2-deg: the grid is empty; expected FROM < TO");
  }
}

nlohmann::ordered_json Reduce(const ReduceOptions& options) {
  if (!options.system.empty()) {
    return SystemReductionJson(LoadLinearSystem(options.system), options.reduction);
  }
  if (options.output.given()) MakeOutputFolder(options.output.file, options.output.overwrite);
  const ArmModel model(options.config.Load().arm, {options.modes, options.modes});
  const NominalMotion motion{options.theta2_deg * kRadPerDeg, options.theta1_rate_rad_s,
                             options.theta2_rate_rad_s};
  nlohmann::ordered_json json = ArmReductionJson(model, motion, options.reduction);
  if (options.with_grid) {
    const std::vector<NominalMotion> centres = CentresOf(options.grid);
    const std::vector<ReductionCell> cells =
        ReduceCells(model, centres, options.reduction, ProgressBar("cells", centres.size()));
    json["grid"] = GridJson(options.grid, cells);
    if (options.output.given()) {
      WriteCells(cells, options.output.file / "grid.csv");
    }
  }
  if (options.output.given()) {
    for (const auto& file : DrawReductionFigures(model, options.reduction, options.output.file)) {
      ReportWritten(file);
    }
  }
  return json;
}

void AddMotion(CLI::App* verb, ReduceOptions* options) {
  verb->add_option("--modes", options->modes, "Bending modes a link")
      ->check(CLI::Range(1, kMaxModesPerLink))
      ->capture_default_str();
  verb->add_option("--theta2-deg", options->theta2_deg, "Elbow angle")
      ->check(NumberWithin(-180.0, 180.0))
      ->capture_default_str();
  verb->add_option("--theta1-rate", options->theta1_rate_rad_s, "Constant rate of joint 1, rad/s")
      ->check(NumberWithin(-100.0, 100.0))
      ->capture_default_str();
  verb->add_option("--theta2-rate", options->theta2_rate_rad_s, "Constant rate of joint 2, rad/s")
      ->check(NumberWithin(-100.0, 100.0))
      ->capture_default_str();
  const std::map<std::string, ModalScaling> scalings = {{"mass", ModalScaling::kMass},
                                                        {"length", ModalScaling::kLength},
                                                        {"tip", ModalScaling::kTip}};
  verb->add_option("--scaling", options->reduction.scaling,
                   "Modal coordinates for modes of 1 kg (mass), of int psi^2 = L (length), of "
                   "psi(L) = 1 (tip)")
      ->transform(CLI::CheckedTransformer(scalings).description("{length,mass,tip}"))
      ->type_name("NAME")
      ->default_str("mass");
}

void AddGrid(CLI::App* verb, ReduceOptions* options) {
  verb->add_flag("--grid", options->with_grid,
                 "Repeat it over a grid of elbow angles and both rates, on all cores");
  verb->add_option("--grid-cells", options->grid.cells, "Intervals of the grid on each axis")
      ->check(CLI::Range(1, 200))
      ->capture_default_str();
  verb->add_option("--grid-theta2-deg", options->grid.theta2_deg, "Elbow angles of the grid")
      ->type_name("FROM TO")
      ->check(NumberWithin(-180.0, 180.0));
  verb->add_option("--grid-theta1-rate", options->grid.theta1_rate_rad_s,
                   "Largest rate of joint 1 in the grid, rad/s")
      ->check(NumberWithin(1e-6, 100.0))
      ->capture_default_str();
  verb->add_option("--grid-theta2-rate", options->grid.theta2_rate_rad_s,
                   "Largest rate of joint 2 in the grid, rad/s")
      ->check(NumberWithin(1e-6, 100.0))
      ->capture_default_str();
}

}  // namespace

void RegisterAnalyzeReduce(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<ReduceOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "reduce",
      "Reduce the order: contribution of each mode by power balancing and by Gramians (chapter 6)");
  options->config.AddTo(verb, false);
  AddMotion(verb, options.get());
  AddGrid(verb, options.get());
  verb->add_option("--system", options->system,
                   "Any linear system instead of an arm: JSON with matrices M, K, optionally D, B, "
                   "C, or A, B, C, as arrays of rows")
      ->type_name("FILE");
  verb->add_option("--rigid-below", options->reduction.rigid_below_rad2_s2,
                   "Roots of smaller magnitude are rigid-body motions, rad^2/s^2")
      ->check(NumberWithin(0.0, 1e6))
      ->capture_default_str();
  AddJson(verb, &options->json);
  options->output.AddTo(
      verb, "Folder for pictures like figures 6.3 to 6.9, and for the grid as CSV", false, "DIR");
  verb->footer(
      "Prints the share of the first k modes of each link, and the Hankel singular values.\n"
      "Example: flexarm analyze reduce -c config/thesis-rig.toml --theta2-deg 45 --theta1-rate -1\n"
      "             --theta2-rate 3 --grid -o order");
  verb->callback([options] {
    Check(*options);
    const nlohmann::ordered_json json = Reduce(*options);
    if (options->json) {
      std::cout << PrintedJson(json) << '\n';
    } else {
      PrintReduction(json);
    }
  });
}

}  // namespace flexarm
