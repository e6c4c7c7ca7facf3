#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "config/config_place.h"
#include "config/plausibility/plausibility.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "model/units.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/csv/csv_report.h"
#include "tools/flexarm/bus_timing_report.h"

namespace flexarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::array<const char*, kCounters> kCounterNames = {"hub1", "hub2", "rotor1", "rotor2"};

struct ConfigCheckOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;
  std::filesystem::path csv;  // empty: none
  bool json = false;
};

OrderedJson ArmJson(const RigConfig& config) {
  const ArmParameters& arm = config.arm;
  const ArmModel model(arm, {2, 2});
  OrderedJson json;
  json["link_length_m"] = {arm.link[0].length_m(), arm.link[1].length_m()};
  json["link_mass_kg"] = {arm.link[0].mass_kg(), arm.link[1].mass_kg()};
  for (const bool held : {false, true}) {
    const Eigen::VectorXd hz =
        held ? HeldMotorFrequenciesHz(model, 0) : FreeMotorFrequenciesHz(model, 0);
    const Eigen::Index lowest = std::min<Eigen::Index>(4, hz.size());
    json[held ? "motors_held_frequency_hz" : "motors_free_frequency_hz"] =
        std::vector<double>(hz.begin(), hz.begin() + lowest);
  }
  return json;
}

// A counter unwraps uniquely while it moves by less than half its range between two readings; the
// bound allows for one lost reading.
OrderedJson EncoderJson(const EncoderConfig& encoder, double period_s) {
  const double rad_per_count = kTwoPi / encoder.counts_per_turn;
  const double half_range = std::ldexp(1.0, encoder.counter_bits - 1);
  return {{"joint", kCounterNames[static_cast<std::size_t>(encoder.counter)]},
          {"resolution_deg", 360 / encoder.counts_per_turn},
          {"unwraps_below_rad_s", half_range * rad_per_count / (2 * period_s)}};
}

OrderedJson StrainJson(const SensorConfig& sensors) {
  OrderedJson json;
  for (const int link : {1, 2}) {
    int channels = 0;
    for (const StrainChannelConfig& channel : sensors.strain)
      channels += channel.link == link ? 1 : 0;
    json["channels"].push_back(channels);
  }
  if (sensors.strain.empty()) return json;
  const double gain = std::abs(sensors.strain.front().gain_v_per_unit);
  json["resolution_microstrain"] = 1e6 * sensors.strain_input.volts_per_count() / gain;
  json["full_scale_microstrain"] = 1e6 * sensors.strain_input.range_v / gain;
  return json;
}

// An arm whose every value is allowed may still have no natural frequencies, as with a mass of
// 1e-30.
OrderedJson CheckedArmJson(const RigConfig& config, const std::filesystem::path& file) {
  try {
    return ArmJson(config);
  } catch (const std::runtime_error& error) {
    const std::string cause = error.what();
    const bool of_link = cause.starts_with("link 1") || cause.starts_with("link 2");
    const std::string key = of_link ? "link" + cause.substr(5, 1) : std::string("arm");
    throw ConfigError({{file.string(), 0, key, "", "must give an arm that vibrates: " + cause}});
  }
}

OrderedJson Derived(const RigConfig& config, const std::filesystem::path& file) {
  const double period_s = config.loop.period_s();
  OrderedJson json;
  json["valid"] = true;
  json["rig"] = config.rig_name;
  json["backend"] = config.backend.empty() ? OrderedJson(nullptr) : OrderedJson(config.backend);
  json["rate_hz"] = 1 / period_s;
  json["arm"] = CheckedArmJson(config, file);
  for (const EncoderConfig& encoder : config.sensors.encoder) {
    json["encoders"].push_back(EncoderJson(encoder, period_s));
  }
  json["strain"] = StrainJson(config.sensors);
  AddWiring(config, &json);
  json["csv"] = CsvMappingJson(config);
  return json;
}

OrderedJson WarningsJson(const ConfigCheckOptions& options, const RigConfig& config) {
  const std::vector<ImplausibleValue> values = ImplausibleValues(config);
  std::vector<std::string> keys;
  for (const ImplausibleValue& value : values) keys.push_back(value.key);
  const std::vector<ConfigPlace> places = PlacesOf(options.file, options.overrides, keys);
  OrderedJson json = OrderedJson::array();
  for (std::size_t i = 0; i < values.size(); ++i) {
    json.push_back({{"file", places[i].file},
                    {"line", places[i].line},
                    {"key", values[i].key},
                    {"value", values[i].value},
                    {"unusual", values[i].unusual},
                    {"usual", values[i].usual}});
  }
  return json;
}

OrderedJson ProblemsJson(const ConfigError& error) {
  OrderedJson json;
  json["valid"] = false;
  for (const ConfigProblem& problem : error.problems()) {
    json["problems"].push_back({{"file", problem.file},
                                {"line", problem.line},
                                {"key", problem.key},
                                {"value", problem.value},
                                {"rule", problem.rule}});
  }
  return json;
}

std::string Number(const OrderedJson& value) {
  std::ostringstream text;
  text << std::setprecision(4) << value.get<double>();
  return text.str();
}

std::string List(const OrderedJson& values) {
  std::string text;
  for (const OrderedJson& value : values) text += (text.empty() ? "" : ", ") + Number(value);
  return text;
}

void PrintWarnings(const OrderedJson& warnings) {
  for (const OrderedJson& warning : warnings) {
    const int line = warning["line"];
    std::cout << Shown(warning["file"].get<std::string>(), kMessageBytes)
              << (line > 0 ? ":" + std::to_string(line) : std::string())
              << ": warning: " << warning["key"].get<std::string>() << " = "
              << warning["value"].get<std::string>() << ": "
              << warning["unusual"].get<std::string>()
              << "; usual: " << warning["usual"].get<std::string>() << '\n';
  }
}

void PrintText(const ConfigCheckOptions& options, const OrderedJson& json) {
  const auto line = [](const std::string& name, const std::string& value) {
    std::cout << "  " << std::left << std::setw(26) << name << value << '\n';
  };
  std::cout << Shown(options.file.string(), kMessageBytes) << ": valid\n";
  line("rig", Shown(json["rig"].get<std::string>()));
  line("backend", json["backend"].is_null() ? "none: [hal] is missing" : json["backend"]);
  line("rate", Number(json["rate_hz"]) + " Hz");
  const OrderedJson& arm = json["arm"];
  line("link lengths", List(arm["link_length_m"]) + " m");
  line("link masses", List(arm["link_mass_kg"]) + " kg");
  line("frequencies, motors free", List(arm["motors_free_frequency_hz"]) + " Hz");
  line("frequencies, motors held", List(arm["motors_held_frequency_hz"]) + " Hz");
  for (const OrderedJson& encoder : json["encoders"]) {
    line("encoder " + encoder["joint"].get<std::string>(),
         Number(encoder["resolution_deg"]) + " deg per count, unwraps below " +
             Number(encoder["unwraps_below_rad_s"]) + " rad/s");
  }
  const OrderedJson& strain = json["strain"];
  line("strain channels", List(strain["channels"]));
  if (strain.contains("resolution_microstrain")) {
    line("strain resolution", Number(strain["resolution_microstrain"]) + " microstrain of +-" +
                                  Number(strain["full_scale_microstrain"]));
  }
  PrintWiring(json);
  if (!json["csv"].is_null()) {
    std::cout << "  columns of a CSV file:\n";
    for (const std::string& text : CsvMappingText(json["csv"])) std::cout << "    " << text << '\n';
  }
  PrintWarnings(json["warnings"]);
  if (json["csv_file"].is_null()) return;
  std::cout << Shown(options.csv.string(), kMessageBytes) << ":\n";
  for (const std::string& text : CsvFactsText(json["csv_file"])) std::cout << "  " << text << '\n';
}

void Check(const ConfigCheckOptions& options) {
  try {
    const RigConfig config = LoadConfig(options.file, options.overrides);
    OrderedJson json = Derived(config, options.file);
    json["warnings"] = WarningsJson(options, config);
    json["csv_file"] =
        options.csv.empty() ? OrderedJson(nullptr) : CsvFileJson(options.csv, config);
    const OrderedJson& file = json["csv_file"];
    const bool refused = !file.is_null() && !file["problem"].is_null();
    if (options.json) {
      std::cout << PrintedJson(json) << '\n';
    } else if (!refused) {
      PrintText(options, json);
    }
    if (refused) {
      std::string problem = file["problem"];
      for (const std::string& text : CsvFactsText(file)) problem += "\n  " + text;
      throw InputError(problem);
    }
  } catch (const ConfigError& error) {
    if (options.json) std::cout << PrintedJson(ProblemsJson(error)) << '\n';
    throw;
  }
}

}  // namespace

void RegisterConfig(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<ConfigCheckOptions>();
  CLI::App* verb = app.add_subcommand("config", "Write, check, show and explain configs");
  verb->require_subcommand(1);
  RegisterConfigNew(*verb, exit);
  RegisterConfigShow(*verb, exit);
  RegisterConfigReference(*verb, exit);
  CLI::App* check = verb->add_subcommand(
      "check",
      "Validate a config: print every problem with its line, or else the quantities derived from "
      "it and a warning for every value that hardly any arm has; for a hardware rig also the time "
      "of "
      "every channel and the scaling of the torques");
  check->add_option("file", options->file, "Config of the rig, a TOML file")
      ->required()
      ->type_name("FILE");
  AddSet(check, &options->overrides);
  check
      ->add_option("--csv", options->csv,
                   "CSV file to check as well: which columns are used, not used and missing, and "
                   "the rate of its rows")
      ->type_name("FILE");
  AddJson(check, &options->json);
  check->footer(
      "Exit code 2 if the config is not valid, or the CSV file cannot be replayed. A warning, such "
      "as a modulus of 207 Pa, leaves it "
      "0.\n"
      "Example: flexarm config check config/thesis-rig.toml");
  check->callback([options] { Check(*options); });
}

}  // namespace flexarm
