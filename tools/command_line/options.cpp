#include "tools/command_line/options.h"

#include <CLI/CLI.hpp>
#include <array>
#include <iostream>
#include <sstream>
#include <string_view>
#include <utility>

#include "config/config_reference.h"
#include "config/fitted_experiment.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "tools/command_line/completion.h"

namespace flexarm {
namespace {

// Keys outside of rows, as --set begins with them.
std::vector<std::string> KeysToSet() {
  std::vector<std::string> words;
  for (const ListedKey& key : RigReference().keys) {
    if (key.path.find('[') == std::string::npos) words.push_back(key.path + "=");
  }
  return words;
}

}  // namespace

void ConfigOptions::AddTo(CLI::App* verb, bool required) {
  verb->add_option("-c,--config", file, "Config of the rig, a TOML file")
      ->required(required)
      ->type_name("FILE");
  AddSet(verb, &overrides);
}

RigConfig ConfigOptions::Load() const {
  if (!given()) throw InputError("--set needs --config FILE");
  return LoadConfig(file, overrides);
}

void AddSet(CLI::App* verb, std::vector<std::string>* overrides) {
  CLI::Option* set =
      verb->add_option("--set", *overrides,
                       "Replace a value of the config, e.g. --set controller.alpha=2.5; repeatable")
          ->type_name("KEY=VALUE")
          ->allow_extra_args(false);  // one value each: the next argument may be a run log
  OfferWords(set, KeysToSet);
}

void GridOptions::AddTo(CLI::App* verb) {
  verb->add_option("--shard", shard,
                   "Only the I-th of N parts, 1 <= I <= N; `flexarm sweep merge` joins them")
      ->type_name("I/N");
  verb->add_option("--jobs", jobs, "Number of parallel runs (default: one per core)")
      ->type_name("J")
      ->check(NumberWithin(1, 1024));
}

std::filesystem::path ExperimentsFolder(const std::filesystem::path& config,
                                        const std::string& file) {
  std::error_code ignored;
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::array<std::filesystem::path, 4> folders = {
      config.parent_path() / "experiments", "config/experiments",
      program / "../share/flexarm/config/experiments", program / "../../../config/experiments"};
  for (const std::filesystem::path& folder : folders) {
    if (std::filesystem::exists(folder / file, ignored)) return folder.lexically_normal();
  }
  throw InputError("found no experiments/" + file + " beside " +
                   Shown(config.string(), kMessageBytes) +
                   ", in config/experiments or with the program: name one with --experiment FILE");
}

ChosenExperiment ChooseExperiment(const std::filesystem::path& given,
                                  const std::filesystem::path& config_file,
                                  const RigConfig& config) {
  if (!given.empty()) return {.file = given, .experiment = LoadExperiment(given)};
  const char* name = IsScheduled(config.controller.kind) ? "moves.toml" : "square-30deg.toml";
  const std::filesystem::path file = ExperimentsFolder(config_file, name) / name;
  const FittedExperiment fitted = FitExperiment(LoadExperiment(file), config);
  if (!fitted.how.empty()) {
    std::cerr << "flexarm: note: " << Shown(file.string(), kMessageBytes)
              << " is fitted to this rig: " << fitted.how << '\n';
  }
  return {.file = file, .experiment = fitted.experiment};
}

std::function<std::string(const std::string&)> NumberWithin(double low, double high) {
  return [low, high](const std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high)
      return std::string();
    std::ostringstream told;
    told << "found " << text << ", expected a number from " << low << " to " << high;
    return told.str();
  };
}

void AddJson(CLI::App* verb, bool* json) {
  verb->add_flag("--json", *json, "Print one JSON object instead of text");
}

void ReportWritten(const std::filesystem::path& file) {
  std::cerr << "wrote " << Shown(file.string(), kMessageBytes) << '\n';
}

void CheckPicture(const std::filesystem::path& output, const OutputRules& rules) {
  const auto extension = output.extension();
  if (extension == ".png" || extension == ".svg") return CheckOutput(output, rules);
  throw InputError(Shown(output.string()) + ": found extension \"" + Shown(extension.string()) +
                   "\", expected .png or .svg");
}

void OutputOptions::AddTo(CLI::App* verb, const std::string& what, bool required,
                          const char* type) {
  verb->add_option("-o,--output", file, what)->required(required)->type_name(type);
  const bool folder = std::string_view(type) == "DIR";
  verb->add_flag("--overwrite", overwrite,
                 folder ? "Write into a folder that has files, and replace those of the same name"
                        : "Replace an existing file, whatever it is");
}

OutputRules OutputOptions::Rules(const char* kind, const char* mark,
                                 std::vector<std::filesystem::path> inputs) const {
  return {.kind = kind, .mark = mark, .inputs = std::move(inputs), .overwrite = overwrite};
}

void AddOutput(CLI::App* verb, std::filesystem::path* file, const std::string& what) {
  verb->add_option("-o,--output", *file, what)->required()->type_name("FILE");
}

}  // namespace flexarm
