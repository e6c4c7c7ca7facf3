#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "config/config.h"
#include "config/new_rig/arm_description.h"
#include "config/new_rig/rig_text.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/tuning/first_motion.h"
#include "tools/tuning/new_rig_search.h"

namespace flexarm {
namespace {

struct NewOptions {
  std::filesystem::path from;
  OutputOptions output;
  std::map<std::string, std::string> values;  // by key, as given
  bool json = false;
};

std::string MaterialList() {
  std::string text;
  for (const Material& material : Materials()) {
    text += std::string(text.empty() ? "" : ", ") + material.name;
  }
  return text;
}

std::string Question(const std::string& key) {
  for (const ArmKey& known : ArmKeys()) {
    if (key == known.key) return known.meaning;
  }
  return "material of both links: " + MaterialList();
}

// Asks on the terminal for what is missing.
void Ask(ArmDescriptionReader* reader) {
  const std::vector<std::string> missing = reader->Missing();
  if (missing.empty() || isatty(STDIN_FILENO) != 1) return;
  std::cerr << missing.size() << " values are missing (end with Ctrl-D).\n";
  for (const std::string& key : missing) {
    std::cerr << key << " - " << Question(key) << ": " << std::flush;
    std::string answer;
    if (!std::getline(std::cin, answer)) return;
    if (!answer.empty()) reader->Set(key, answer);
  }
}

// Beside the config.
std::filesystem::path FirstMotionFile(const std::filesystem::path& config) {
  return config.parent_path() / "first-motion.toml";
}

nlohmann::ordered_json ToJson(const NewRigResult& result, const std::filesystem::path& file) {
  nlohmann::ordered_json json;
  json["passed"] = result.passed;
  json["config"] =
      result.passed ? nlohmann::ordered_json(file.string()) : nlohmann::ordered_json(nullptr);
  json["first_motion"] = result.passed ? nlohmann::ordered_json(FirstMotionFile(file).string())
                                       : nlohmann::ordered_json(nullptr);
  json["design_score"] = result.design_score;
  json["largest_error_mm"] = result.largest_error_mm;
  json["permitted_error_mm"] = result.permitted_mm;
  json["notes"] = result.notes;
  json["proposal"] =
      result.proposal ? nlohmann::ordered_json(*result.proposal) : nlohmann::ordered_json(nullptr);
  return json;
}

void PrintText(const NewRigResult& result, const std::filesystem::path& file) {
  for (const std::string& note : result.notes) std::cout << note << '\n';
  if (!result.passed) return;
  const std::string name = Shown(file.string(), kMessageBytes);
  const std::string first = Shown(FirstMotionFile(file).string(), kMessageBytes);
  std::printf(
      "wrote %s: every check of the design passed, and in simulated moves to random places, with "
      "the\nleast, the usual and the greatest payload, the tip ended within %.1f mm of its target "
      "(%.1f permitted)\n"
      "wrote %s: a small, slow motion to begin with\n"
      "next: flexarm simulate -c %s\n"
      "      flexarm config show %s    every value with its source\n"
      "      values marked \"assumed\" should be measured: docs/own-arm.md\n",
      name.c_str(), result.largest_error_mm, result.permitted_mm, first.c_str(), name.c_str(),
      name.c_str());
}

int New(const NewOptions& options) {
  const OutputRules rules = options.output.Rules("a new config", kNewRigMark, {options.from});
  CheckOutput(options.output.file, rules);
  const std::filesystem::path first_motion = FirstMotionFile(options.output.file);
  const OutputRules first_rules =
      options.output.Rules("a first motion", kFirstMotionMark, {options.from});
  CheckOutput(first_motion, first_rules);
  ArmDescriptionReader reader(options.from);
  for (const auto& [key, value] : options.values) reader.Set(key, value);
  Ask(&reader);
  const ArmDescription arm = reader.Read();
  const bool show = isatty(STDERR_FILENO) == 1 && !options.json;
  const NewRigResult result = FindRig(arm, [show](const std::string& what) {
    if (show) std::cerr << "\r\033[K" << what << " .." << std::flush;
  });
  if (show) std::cerr << "\r\033[K";
  if (result.passed) {
    WriteFile(options.output.file, result.text, rules);
    const RigConfig config = LoadConfig(options.output.file);
    WriteFile(first_motion, FirstMotion(config), first_rules);
  }
  if (options.json) {
    std::cout << PrintedJson(ToJson(result, options.output.file)) << '\n';
  } else {
    PrintText(result, options.output.file);
  }
  if (result.passed) return Exit::kDone;
  std::cerr << "flexarm: no config was written: this arm cannot be controlled as described"
            << (result.proposal ? "; it can with " + *result.proposal : std::string()) << '\n';
  return Exit::kFailed;
}

}  // namespace

void RegisterConfigNew(CLI::App& config, Exit& exit) {
  const auto options = std::make_shared<NewOptions>();
  CLI::App* verb = config.add_subcommand(
      "new", "Write the config of another arm from a few numbers: everything else is derived");
  verb->add_option("--from", options->from,
                   "Description of the arm, a TOML file with the keys below")
      ->type_name("ARM.toml");
  options->output.AddTo(verb, "Config to write", true);
  const auto add = [&](const std::string& key, const std::string& text) {
    verb->add_option("--" + key, options->values[key], text)->type_name("VALUE");
  };
  for (const ArmKey& key : ArmKeys()) {
    add(key.key, std::string(key.meaning) +
                     (key.required ? "" : std::string(" (default: ") + key.otherwise + ")"));
  }
  const std::string materials = MaterialList();
  add("material", "material of both links: " + materials);
  add("link1.material", "material of link 1, if it is not that of both");
  add("link2.material", "material of link 2, if it is not that of both");
  add("name", "name of the rig (default: new-rig)");
  AddJson(verb, &options->json);
  verb->footer(
      "What has no default is asked for on a terminal, and refused by name elsewhere. Values from\n"
      "the command line replace those of the file. Noises, weights, limits and thresholds are\n"
      "derived (docs/theory/derivation.md), the design is checked and tuned if a check fails, and\n"
      "simulated moves must end on their targets; otherwise nothing is written, exit code 1, and\n"
      "the smallest change that helps is named. Beside the config it writes first-motion.toml, "
      "small\n"
      "and slow: no payload trips in simulation, with full and with reduced limits.\n"
      "Example: flexarm config new --from arm.toml -o rig.toml\n"
      "with arm.toml: material = \"steel\"\n"
      "               link1 = {length_m = 0.4, width_mm = 25, thickness_mm = 2}\n"
      "               link2 = {length_m = 0.4, width_mm = 25, thickness_mm = 2}\n"
      "               joint1 = {torque_limit_nm = 10, encoder_counts_per_turn = 8192}\n"
      "               joint2 = {torque_limit_nm = 3, encoder_counts_per_turn = 8192}\n"
      "               elbow_mass_kg = 1.2\n"
      "               tip_mass_kg = 0.3\n"
      "               gauges_per_link = 1\n"
      "               rate_hz = 50");
  verb->callback([options, &exit] {
    std::erase_if(options->values, [](const auto& entry) { return entry.second.empty(); });
    exit.code = New(*options);
  });
}

}  // namespace flexarm
