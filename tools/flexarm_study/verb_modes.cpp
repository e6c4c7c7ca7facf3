#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "controller/files/external_json.h"
#include "controller/runlog/errors.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "model/beam/link_modes.h"
#include "model/beam_methods/exact_arm.h"
#include "model/beam_methods/friction_root.h"
#include "model/units.h"
#include "tools/analysis/beam_report.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {
namespace {

constexpr double kConverged = 0.01;  // relative, of the model with M modes against the exact arm

struct ModesOptions {
  ConfigOptions config;
  int modes = 4;
  double theta2_deg = 0;
  std::optional<double> payload_kg;
  std::string base = "clamped";
  std::optional<double> base_spring_nm_per_rad;
  bool convergence = false;
  std::vector<double> friction_amplitude_mm;
  std::vector<double> friction_nm;  // joints 1 and 2; empty: the config's
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
  const std::vector<double> exact_hz = ExactArm(model.parameters(), theta2_rad)
                                           .FrequenciesHz(static_cast<int>(frequency.size()), held);
  nlohmann::ordered_json json;
  json["theta2_deg"] = options.theta2_deg;
  json["payload_kg"] = model.parameters().payload_mass_kg;
  json["motors"] = held ? "held" : "free";
  json["frequency_hz"] = std::vector<double>(frequency.begin(), frequency.end());
  json["exact_hz"] = exact_hz;
  for (std::size_t i = 0; i < exact_hz.size(); ++i) {
    const double error = frequency[static_cast<Eigen::Index>(i)] / exact_hz[i] - 1.0;
    json["converged"].push_back(std::abs(error) <= kConverged);
  }
  return json;
}

// The friction of a joint as the support of its link's root, over the amplitudes.
nlohmann::ordered_json FrictionJson(const ModesOptions& options, const ArmParameters& arm,
                                    const LinkBeam& beam) {
  const std::size_t i = static_cast<std::size_t>(beam.link) - 1;
  const double friction_nm =
      options.friction_nm.empty() ? arm.joint[i].coulomb_friction_nm : options.friction_nm[i];
  nlohmann::ordered_json json{{"link", beam.link}, {"friction_nm", friction_nm}};
  for (const double amplitude_mm : options.friction_amplitude_mm) {
    nlohmann::ordered_json row{{"amplitude_mm", amplitude_mm}};
    for (int mode = 1; mode <= options.modes; ++mode) {
      const FrictionRoot root =
          FrictionRootMode(beam.section, beam.tip, mode, 1e-3 * amplitude_mm, friction_nm);
      row["sticks"].push_back(root.sticks);
      row["clamped_moment_nm"].push_back(root.clamped_moment_nm);
      row["frequency_hz"].push_back(root.frequency_rad_s / kTwoPi);
    }
    json["amplitudes"].push_back(row);
  }
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
  if (!options.friction_amplitude_mm.empty()) {
    for (const LinkBeam& beam : beams)
      json["friction_roots"].push_back(FrictionJson(options, arm, beam));
  }
  json["arm"] = ArmJson(options, model, false);
  json["arm_motors_held"] = ArmJson(options, model, true);
  if (options.convergence) {
    for (std::size_t i = 0; i < beams.size(); ++i) {
      json["convergence"].push_back(ConvergenceJson(beams[i], modes[i]));
    }
  }
  if (options.output.given()) {
    DrawBeams(beams, modes, options.convergence, options.output.file,
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

// The frequencies of the model with M modes, and below those that have not converged, the exact
// ones.
void PrintArm(const std::string& motors, const nlohmann::ordered_json& arm) {
  PrintFigures("arm, motors " + motors + ": Hz", arm["frequency_hz"]);
  if (std::all_of(arm["converged"].begin(), arm["converged"].end(),
                  [](const auto& converged) { return converged.template get<bool>(); })) {
    return;
  }
  std::cout << std::left << std::setw(30) << "  not converged; exact: Hz" << std::right;
  for (std::size_t i = 0; i < arm["converged"].size(); ++i) {
    std::cout << ' ' << std::setw(10);
    if (arm["converged"][i].get<bool>()) {
      std::cout << "";
    } else {
      std::cout << arm["exact_hz"][i].get<double>();
    }
  }
  std::cout << '\n';
}

void PrintFrictionRoots(const nlohmann::ordered_json& links) {
  for (const auto& link : links) {
    for (const auto& row : link["amplitudes"]) {
      std::ostringstream name;
      name << "link " << link["link"].get<int>() << ", friction "
           << link["friction_nm"].get<double>() << " N m, " << row["amplitude_mm"].get<double>()
           << " mm at its tip";
      std::cout << name.str() << '\n';
      PrintFigures("  clamped moment, N m", row["clamped_moment_nm"]);
      PrintFigures("  Hz", row["frequency_hz"]);
      std::cout << std::left << std::setw(30) << "  the joint" << std::right;
      for (const auto& sticks : row["sticks"]) {
        std::cout << ' ' << std::setw(10) << (sticks.get<bool>() ? "sticks" : "slips");
      }
      std::cout << '\n';
    }
  }
}

void PrintModes(const nlohmann::ordered_json& json) {
  std::cout << std::setprecision(6);
  for (const auto& link : json["links"]) {
    const std::string name = "link " + std::to_string(link["link"].get<int>()) + ", " +
                             link["base"].get<std::string>() + ": ";
    PrintFigures(name + "beta L", link["beta_l"]);
    PrintFigures(name + "Hz", link["frequency_hz"]);
  }
  PrintArm("free", json["arm"]);
  PrintArm("held", json["arm_motors_held"]);
  if (json.contains("friction_roots")) PrintFrictionRoots(json["friction_roots"]);
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

void AddFriction(CLI::App* verb, ModesOptions* options) {
  verb->add_option("--friction-amplitude-mm", options->friction_amplitude_mm,
                   "Also each link on a root that only dry friction holds (thesis 3.2), at these "
                   "amplitudes of its tip")
      ->check(NumberWithin(1e-6, 1e6))
      ->type_name("MM ..");
  verb->add_option("--friction-nm", options->friction_nm,
                   "Friction of joints 1 and 2 for it, instead of the config's")
      ->check(NumberWithin(0.0, 1e6))
      ->expected(2)
      ->type_name("T1 T2")
      ->needs("--friction-amplitude-mm");
}

}  // namespace

void RegisterModes(CLI::App& app, Exit&) {
  const auto options = std::make_shared<ModesOptions>();
  CLI::App* verb = AddOtherVerb(app, "modes");
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
  AddFriction(verb, options.get());
  AddJson(verb, &options->json);
  options->output.AddTo(verb, "Picture of shapes, frequencies and convergence, .png or .svg",
                        false);
  verb->footer(
      "The arm's frequencies are those of the model with the given number of modes. exact_hz has\n"
      "those of the arm with distributed mass; a frequency within 1 % of it is called converged.\n"
      "Example: flexarm modes -c config/thesis-rig.toml --theta2-deg 45 --payload-kg 0.2");
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
