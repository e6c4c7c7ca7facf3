#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "controller/files/external_json.h"
#include "controller/runlog/errors.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "model/beam/link_modes.h"
#include "model/units.h"
#include "tools/analysis/beam_report.h"
#include "tools/command_line/options.h"
#include "tools/command_line/studies.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {
namespace {

struct ModesOptions {
  ConfigOptions config;
  int modes = 4;
  double theta2_deg = 0;
  std::optional<double> payload_kg;
  std::string base = "clamped";
  std::optional<double> base_spring_nm_per_rad;
  bool convergence = false;
  bool json = false;
  OutputOptions output;
};

BeamRoot RootOf(const ModesOptions& options) {
  const bool spring = options.base == "spring";
  if (spring != options.base_spring_nm_per_rad.has_value()) {
    throw InputError(
        "modes: --base spring needs --base-spring-nm-per-rad, and the other way round");
  }
  if (spring) return BeamRoot::Spring(*options.base_spring_nm_per_rad);
  return options.base == "pinned" ? BeamRoot::Pinned() : BeamRoot::Clamped();
}

nlohmann::ordered_json ArmJson(const ModesOptions& options, const ArmModel& model, bool held) {
  const double theta2_rad = options.theta2_deg * kRadPerDeg;
  const Eigen::VectorXd frequency =
      held ? HeldMotorFrequenciesHz(model, theta2_rad) : FreeMotorFrequenciesHz(model, theta2_rad);
  nlohmann::ordered_json json;
  json["theta2_deg"] = options.theta2_deg;
  json["payload_kg"] = model.parameters().payload_mass_kg;
  json["motors"] = held ? "held" : "free";
  json["frequency_hz"] = std::vector<double>(frequency.begin(), frequency.end());
  return json;
}

nlohmann::ordered_json Modes(const ModesOptions& options) {
  if (options.output.given())
    CheckPicture(options.output.file,
                 PictureRules({options.config.file}, options.output.overwrite));
  ArmParameters arm = options.config.Load().arm;
  // The shapes get this payload too: the frequencies converge faster with the number of modes.
  if (options.payload_kg) arm.payload_mass_kg = arm.shape_payload_mass_kg = *options.payload_kg;
  const BeamRoot root = RootOf(options);
  const ArmModel model(arm, {options.modes, options.modes});
  const std::vector<LinkBeam> beams = {{1, arm.link[0].section, Link1Tip(arm), root, options.base},
                                       {2, arm.link[1].section, Link2Tip(arm), root, options.base}};
  std::vector<std::vector<BeamMode>> modes;
  nlohmann::ordered_json json;
  for (const LinkBeam& beam : beams) {
    modes.push_back(NaturalModes(beam.section, beam.tip, root, options.modes,
                                 "link " + std::to_string(beam.link)));
    json["links"].push_back(BeamJson(beam, modes.back()));
  }
  json["arm"] = ArmJson(options, model, false);
  json["arm_motors_held"] = ArmJson(options, model, true);
  if (options.convergence) {
    for (std::size_t i = 0; i < beams.size(); ++i) {
      json["convergence"].push_back(ConvergenceJson(beams[i], modes[i]));
    }
  }
  if (options.output.given()) {
    DrawBeams(beams, modes, options.output.file,
              PictureRules({options.config.file}, options.output.overwrite));
    ReportWritten(options.output.file);
  }
  return json;
}

void PrintFigures(const std::string& name, const nlohmann::ordered_json& values) {
  std::cout << std::left << std::setw(30) << name << std::right;
  for (const double value : values) std::cout << ' ' << std::setw(10) << value;
  std::cout << '\n';
}

void PrintModes(const nlohmann::ordered_json& json) {
  std::cout << std::setprecision(6);
  for (const auto& link : json["links"]) {
    const std::string name = "link " + std::to_string(link["link"].get<int>()) + ", " +
                             link["base"].get<std::string>() + ": ";
    PrintFigures(name + "beta L", link["beta_l"]);
    PrintFigures(name + "Hz", link["frequency_hz"]);
  }
  PrintFigures("arm, motors free: Hz", json["arm"]["frequency_hz"]);
  PrintFigures("arm, motors held: Hz", json["arm_motors_held"]["frequency_hz"]);
  if (!json.contains("convergence")) return;
  std::cout << std::setprecision(4);
  for (const auto& link : json["convergence"]) {
    const std::string name = "link " + std::to_string(link["link"].get<int>()) + ", ";
    for (std::size_t i = 0; i < link["parts"].size(); ++i) {
      PrintFigures(name + std::to_string(link["parts"][i].get<int>()) + " parts: error %",
                   link["error_percent"][i]);
    }
    PrintFigures(name + "fit (3.7): residual", link["fit_rms_residual"]);
  }
}

void AddBase(CLI::App* verb, ModesOptions* options) {
  verb->add_option("--base", options->base, "Boundary condition at the root of each single link")
      ->check(CLI::IsMember({"clamped", "pinned", "spring"}))
      ->capture_default_str();
  verb->add_option("--base-spring-nm-per-rad", options->base_spring_nm_per_rad,
                   "Torsion spring of --base spring")
      ->check(NumberWithin(1e-9, 1e12));
  verb->add_flag("--convergence", options->convergence,
                 "Also the error of the thesis's lumped transfer matrix over its number of parts, "
                 "and the fit of its shapes");
}

}  // namespace

void RegisterModes(CLI::App& app, Exit&) {
  const auto options = std::make_shared<ModesOptions>();
  CLI::App* verb = AddStudy(app, "modes");
  options->config.AddTo(verb, true);
  verb->add_option("--modes", options->modes, "Bending modes a link")
      ->check(CLI::Range(1, 6))
      ->capture_default_str();
  verb->add_option("--theta2-deg", options->theta2_deg, "Elbow angle")
      ->check(NumberWithin(-180.0, 180.0))
      ->capture_default_str();
  verb->add_option("--payload-kg", options->payload_kg, "Payload instead of the config's")
      ->check(NumberWithin(0.0, 1000.0));
  AddBase(verb, options.get());
  AddJson(verb, &options->json);
  options->output.AddTo(verb, "Picture of shapes, frequencies and convergence, .png or .svg",
                        false);
  verb->footer("Example: flexarm modes -c config/thesis-rig.toml --theta2-deg 45 --payload-kg 0.2");
  verb->callback([options] {
    const nlohmann::ordered_json json = Modes(*options);
    if (options->json) {
      std::cout << PrintedJson(json) << '\n';
    } else {
      PrintModes(json);
    }
  });
}

}  // namespace flexarm
