#include <CLI/CLI.hpp>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "model/arm_model.h"
#include "model/linearization.h"
#include "model/link_modes.h"
#include "tools/options.h"
#include "tools/verbs.h"

namespace flexarm {
namespace {

constexpr double kRadPerDeg = 0.017453292519943295769;
constexpr double kTwoPi = 6.2831853071795864769;

struct Options {
  ConfigOptions config;
  int modes = 4;
  double theta2_deg = 0;
  std::optional<double> payload_kg;
  bool json = false;
};

nlohmann::ordered_json LinkJson(int link, const LinkModes& modes) {
  nlohmann::ordered_json json{{"link", link}, {"base", "clamped"}};
  json["beta_l"] = nlohmann::ordered_json::array();
  json["frequency_hz"] = nlohmann::ordered_json::array();
  for (const BeamMode& mode : modes.mode) {
    json["beta_l"].push_back(mode.beta_length());
    json["frequency_hz"].push_back(mode.frequency_rad_s() / kTwoPi);
  }
  return json;
}

nlohmann::ordered_json ArmJson(const Options& options, const ArmModel& model, bool held) {
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

nlohmann::ordered_json Modes(const Options& options) {
  ArmParameters arm = options.config.Load().arm;
  // The modes of an arm with this payload: its shapes too, or the figures would converge slower.
  if (options.payload_kg) arm.payload_mass_kg = arm.shape_payload_mass_kg = *options.payload_kg;
  const ArmModel model(arm, {options.modes, options.modes});
  nlohmann::ordered_json json;
  json["links"] = {LinkJson(1, model.link_modes(1)), LinkJson(2, model.link_modes(2))};
  json["arm"] = ArmJson(options, model, false);
  json["arm_motors_held"] = ArmJson(options, model, true);
  return json;
}

void PrintRow(const std::string& name, const nlohmann::ordered_json& values) {
  std::cout << std::left << std::setw(30) << name << std::right;
  for (const double value : values) std::cout << ' ' << std::setw(10) << value;
  std::cout << '\n';
}

void PrintText(const nlohmann::ordered_json& json) {
  std::cout << std::setprecision(6);
  for (const auto& link : json["links"]) {
    const std::string name = "link " + std::to_string(link["link"].get<int>()) + ", clamped: ";
    PrintRow(name + "beta L", link["beta_l"]);
    PrintRow(name + "Hz", link["frequency_hz"]);
  }
  PrintRow("arm, motors free: Hz", json["arm"]["frequency_hz"]);
  PrintRow("arm, motors held: Hz", json["arm_motors_held"]["frequency_hz"]);
}

}  // namespace

void RegisterModes(CLI::App& app, Exit&) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "modes", "Natural frequencies of the links and of the whole arm, undamped");
  options->config.AddTo(verb, true);
  verb->add_option("--modes", options->modes, "Bending modes a link")
      ->check(CLI::Range(1, 6))
      ->capture_default_str();
  verb->add_option("--theta2-deg", options->theta2_deg, "Elbow angle")
      ->check(CLI::Range(-180.0, 180.0))
      ->capture_default_str();
  verb->add_option("--payload-kg", options->payload_kg, "Payload, instead of the config's")
      ->check(CLI::Range(0.0, 1000.0));
  AddJson(verb, &options->json);
  verb->footer("Example: flexarm modes -c config/thesis-rig.toml --theta2-deg 45 --payload-kg 0.2");
  verb->callback([options] {
    const nlohmann::ordered_json json = Modes(*options);
    if (options->json) {
      std::cout << json.dump(2) << '\n';
    } else {
      PrintText(json);
    }
  });
}

}  // namespace flexarm
