#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "controller/design/check_explanation.h"
#include "controller/design/design_controller.h"
#include "controller/design/design_json.h"
#include "controller/design/design_verdict.h"
#include "controller/design/model_following.h"
#include "controller/files/external_json.h"
#include "controller/files/input_error.h"
#include "controller/files/write_file.h"
#include "controller/law/design.h"
#include "controller/types/rejected_error.h"
#include "model/math/invariant_zeros.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/flexarm/design_tuning.h"

namespace flexarm {
namespace {

struct DesignOptions {
  ConfigOptions config;
  OutputOptions output;
  std::vector<double> payload_kg;  ///< empty: those of the config
  bool force = false;
  bool tune = false;
  bool json = false;
};

/// Condition number of the command generator's equation, in the coordinates of the model (psi(L) =
/// 1) and in the scaled coordinates in which it is solved.
struct Conditioning {
  double unscaled, scaled;
};

Conditioning ConditioningOf(const RigConfig& config, const Design& design) {
  TrackingProblem problem = TrackingProblemOf(config, design);
  const double scaled = SteinCondition(problem);
  problem.scale.setOnes();
  return {.unscaled = SteinCondition(problem), .scaled = scaled};
}

nlohmann::ordered_json ToJson(const RobustnessAnalysis& robustness) {
  nlohmann::ordered_json json;
  for (const RobustnessCase& c : robustness.cases) {
    json["cases"].push_back({{"payload_kg", c.payload_kg},
                             {"theta2_deg", c.theta2_deg},
                             {"gain", c.gain},
                             {"required", c.required},
                             {"spectral_radius", c.spectral_radius}});
  }
  json["gain_margin_up"] = robustness.margins.gain_up;
  json["gain_margin_down"] = robustness.margins.gain_down;
  json["delay_margin_ms"] = 1e3 * robustness.margins.delay_s;
  return json;
}

/// What limits every law for this nominal model: thesis 7.2.
struct ControlFeatures {
  ModelFollowing following;       ///< (7.3)
  Integrators integrators;        ///< of the continuous nominal model
  Eigen::VectorXcd output_zeros;  ///< discrete, from the torques to the law's output K x

  int zeros_outside() const {
    return static_cast<int>((output_zeros.cwiseAbs().array() > 1.0).count());
  }
  double largest_zero() const { return output_zeros.cwiseAbs().maxCoeff(); }
};

ControlFeatures FeaturesOf(const RigConfig& config, const Design& design) {
  return {.following = TestModelFollowing(config, design.layout),
          .integrators = CountIntegrators(design.A_rate),
          .output_zeros = InvariantZeros(design.A, design.B, design.K)};
}

nlohmann::ordered_json ToJson(const ControlFeatures& features) {
  const auto ranks = [](const FollowingRanks& r) {
    return nlohmann::ordered_json{
        {"rank_b", r.input}, {"rank_b_a_am", r.difference}, {"rank_b_bm", r.reference}};
  };
  nlohmann::ordered_json json;
  json["model_following"] = {{"satisfied", features.following.continuous.follows()},
                             {"continuous", ranks(features.following.continuous)},
                             {"discrete", ranks(features.following.discrete)}};
  json["poles_at_origin"] = {{"count", features.integrators.poles},
                             {"chains", features.integrators.chains}};
  json["output_zeros_outside_unit_circle"] = features.zeros_outside();
  json["output_zero_largest"] = features.largest_zero();
  return json;
}

void PrintFeatures(const ControlFeatures& features) {
  const FollowingRanks &c = features.following.continuous, &d = features.following.discrete;
  std::printf(
      "\npoles at the origin: %d, in %d chains; zeros from the torques to K x outside the unit\n"
      "circle: %d of %d, up to |z| = %.3g; perfect model following (7.3): rank B = %d, rank [B, A "
      "-\nA_m] = %d (sampled %d, %d): %s\n",
      features.integrators.poles, features.integrators.chains, features.zeros_outside(),
      static_cast<int>(features.output_zeros.size()), features.largest_zero(), c.input,
      c.difference, d.input, d.difference, c.follows() ? "satisfied" : "not satisfied");
}

// What a failed check means and what to do about it.
std::string ExplanationText(const DesignCheck& check) {
  const CheckExplanation* explanation = ExplanationOf(check.name);
  if (explanation == nullptr) return {};
  return std::string(explanation->meaning) + ". To try: " + std::string(explanation->remedy) + ".";
}

nlohmann::ordered_json ToJson(const Design& design, const RobustnessAnalysis& robustness,
                              const Conditioning& conditioning, const ControlFeatures& features,
                              const DesignOptions& options, const std::string& hash) {
  nlohmann::ordered_json json;
  json["nominal"] = NameOf(design.layout);
  json["states"] = design.A.rows();
  json["cgt_stein_condition_unscaled"] = conditioning.unscaled;
  json["cgt_stein_condition"] = conditioning.scaled;
  json["config_hash"] = hash;
  json["sound"] = design.sound();
  for (const DesignCheck& check : design.checks) {
    json["checks"].push_back({{"name", check.name},
                              {"value", check.value},
                              {"limit", check.limit},
                              {"must_be", check.below ? "below" : "above"},
                              {"passed", check.passed()},
                              {"waived", check.waived}});
    const std::string explanation = check.passed() ? "" : ExplanationText(check);
    if (!explanation.empty()) json["checks"].back()["explanation"] = explanation;
  }
  json["robustness"] = ToJson(robustness);
  json["features"] = ToJson(features);
  for (Eigen::Index i = 0; i < design.K.rows(); ++i) {
    json["k"].push_back(std::vector<double>());
    for (Eigen::Index j = 0; j < design.K.cols(); ++j) json["k"].back().push_back(design.K(i, j));
  }
  json["gains"] = design.sound() ? nlohmann::ordered_json(options.output.file.string())
                                 : nlohmann::ordered_json(nullptr);
  return json;
}

// The text broken into lines of a terminal.
void PrintWrapped(const std::string& text) {
  constexpr std::size_t kWidth = 92;
  std::istringstream words(text);
  std::string word, line = " ";
  while (words >> word) {
    if (line.size() + 1 + word.size() > kWidth) {
      std::printf("%s\n", line.c_str());
      line = " ";
    }
    line += " " + word;
  }
  std::printf("%s\n", line.c_str());
}

void PrintExplanations(const Design& design) {
  for (const DesignCheck& check : design.checks) {
    if (check.passed()) continue;
    std::printf("\n%s\n", CheckText(check).c_str());
    PrintWrapped(ExplanationText(check));
  }
}

void PrintRobustness(const RobustnessAnalysis& robustness) {
  std::printf(
      "\nrobustness: largest |eigenvalue| of the closed loop with 4 bending modes a link; below 1 "
      "is\n"
      "stable (!: must be stable; ?: payload and gains both differ); gains x 1, x 0.7, x 1.4\n"
      "%-12s %12s %10s %10s %10s\n",
      "payload, kg", "elbow, deg", "x 1", "x 0.7", "x 1.4");
  for (std::size_t i = 0; i + 2 < robustness.cases.size(); i += 3) {
    std::printf("%-12g %12g", robustness.cases[i].payload_kg, robustness.cases[i].theta2_deg);
    for (std::size_t j = 0; j < 3; ++j) {
      const double radius = robustness.cases[i + j].spectral_radius;
      std::printf(" %9.5f%s", radius,
                  radius < 1.0                       ? " "
                  : robustness.cases[i + j].required ? "!"
                                                     : "?");
    }
    std::printf("\n");
  }
}

// Whether `sobel` brings the arm to rest with this config.
void PrintSettling(const ControlConfig& config) {
  if (!LawOf(config.controller.kind).settles) return;
  const char* why_not = config.why_not_settling();
  if (why_not == nullptr) {
    std::printf(
        "\nat rest: gains of the estimated payload and friction compensation "
        "([controller.settling])\n");
  } else {
    std::printf("\nat rest: as sobel-thesis: %s\n", why_not);
  }
}

void PrintText(const RigConfig& config, const Design& design, const RobustnessAnalysis& robustness,
               const Conditioning& conditioning, const ControlFeatures& features,
               const std::filesystem::path& file) {
  const std::string nominal(NameOf(design.layout));
  const auto states = static_cast<int>(design.A.rows());
  std::printf(
      "nominal model %s: %d states; equation of the command generator (%d unknowns): condition\n"
      "number %.1e in the coordinates of the model, %.1e in those in which it is solved\n\n",
      nominal.c_str(), states, states * states, conditioning.unscaled, conditioning.scaled);
  std::printf("%-34s %12s  %s\n", "check", "value", "must be");
  for (const DesignCheck& check : design.checks) {
    const char* verdict = check.passed() ? "" : check.waived ? "   FAILED, waived" : "   FAILED";
    std::printf("%-34s %12.4g  %s %.4g%s\n", check.name.c_str(), check.value,
                check.below ? "below" : "above", check.limit, verdict);
  }
  PrintExplanations(design);
  PrintRobustness(robustness);
  PrintFeatures(features);
  PrintSettling(config);
  std::printf("\nK (N m per rad, per m, per rad/s, per m/s):\n");
  for (Eigen::Index i = 0; i < design.K.rows(); ++i) {
    for (Eigen::Index j = 0; j < design.K.cols(); ++j) std::printf(" %9.4g", design.K(i, j));
    std::printf("\n");
  }
  if (design.sound()) std::printf("\ngains written to %s\n", file.c_str());
}

int Run(const DesignOptions& options) {
  if (options.tune) {
    RigConfig config = options.config.Load();
    config.controller.gains_file.clear();
    return TuneAndPrint(config, options.json);
  }
  if (!options.output.given()) throw InputError("--output FILE is required, or --tune");
  const OutputRules rules = options.output.Rules("a gains file", kGainsMark, {options.config.file});
  CheckOutput(options.output.file, rules);
  RigConfig config = options.config.Load();
  config.controller.gains_file.clear();  // designs also if the config names gains
  Design design = DesignController(config);
  const DesignVerdict verdict = JudgeDesign(
      config, design,
      options.payload_kg.empty() ? CheckedPayloads_kg(config.controller) : options.payload_kg);
  if (!verdict.robustness) throw std::runtime_error(verdict.found);
  const RobustnessAnalysis& robustness = *verdict.robustness;
  design.checks = verdict.checks;
  for (DesignCheck& check : design.checks) check.waived = options.force && !check.passed();
  const std::string hash = DesignHash(config);
  const Conditioning conditioning = ConditioningOf(config, design);
  if (design.sound()) WriteFile(options.output.file, DesignToJson(design, hash) + '\n', rules);
  const ControlFeatures features = FeaturesOf(config, design);
  if (options.json) {
    nlohmann::ordered_json json = ToJson(design, robustness, conditioning, features, options, hash);
    json["settles"] = config.settles();
    std::cout << PrintedJson(json) << '\n';
  } else {
    PrintText(config, design, robustness, conditioning, features, options.output.file);
  }
  if (!design.sound()) {
    std::cerr << "flexarm: no gains were written: failed: " << verdict.found
              << "; --force writes them anyway and records that in the file\n";
    return Exit::kFailed;
  }
  return Exit::kDone;
}

}  // namespace

void RegisterDesign(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<DesignOptions>();
  CLI::App* verb = app.add_subcommand(
      "design",
      "Design the reference model, gains and filter of a rig, check them and write them to a file");
  options->config.AddTo(verb, true);
  options->output.AddTo(verb, "Gains file to write (JSON)", false);
  verb->add_option("--payload-kg", options->payload_kg,
                   "Payloads with which the closed loop must be stable, kg (default: six of "
                   "controller.payload_range_kg)")
      ->check(NumberWithin(0.0, 100.0))
      ->expected(1, -1);
  verb->add_flag("--force", options->force,
                 "Write the gains even if a check failed; the file and every run's log record it");
  verb->add_flag("--tune", options->tune,
                 "Search noises and weights for the best margins over payloads and elbow angles,\n"
                 "print the lines to change, or what is in the way; writes no file")
      ->excludes("--output")
      ->excludes("--force");
  AddJson(verb, &options->json);
  verb->footer(
      "The nominal model is controller.nominal: R8, R12, T12 or T16.\n"
      "Every check is printed with its value and its limit, a failed one also with its meaning "
      "and\n"
      "the keys that change it; gains that fail a check are not written.\n"
      "The robustness analysis closes the loop around the arm with four bending modes a link, at\n"
      "three elbow angles, with every payload, and with the gains x 0.7 and x 1.4. The gain and\n"
      "delay margins are checked too. The daemon makes the same checks with the payloads of\n"
      "controller.payload_range_kg, and does not arm what fails them. Gains of --force it arms on "
      "the\n"
      "simulated backend; on a wired rig `flexarm arm` needs --override-design REASON as well.\n"
      "To run with these gains, set [controller] gains = \"FILE\" in the config. Without that key\n"
      "the daemon designs the gains at start.\n"
      "Examples: flexarm design -c config/thesis-rig.toml -o gains.json\n"
      "          flexarm design -c rig.toml --tune");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
