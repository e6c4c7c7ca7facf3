#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/law/design.h"
#include "controller/law/refused.h"
#include "controller/runlog/errors.h"
#include "tools/options.h"
#include "tools/verbs.h"

namespace flexarm {
namespace {

struct Options {
  ConfigOptions config;
  std::filesystem::path output;
  bool json = false;
};

nlohmann::ordered_json ToJson(const Design& design, const Options& options,
                              const std::string& hash) {
  nlohmann::ordered_json json;
  json["states"] = design.A.rows();
  json["config_hash"] = hash;
  json["sound"] = design.sound();
  for (const DesignCheck& check : design.checks) {
    json["checks"].push_back({{"name", check.name},
                              {"value", check.value},
                              {"limit", check.limit},
                              {"must_be", check.below ? "below" : "above"},
                              {"passed", check.passed()}});
  }
  for (Eigen::Index i = 0; i < design.K.rows(); ++i) {
    json["k"].push_back(std::vector<double>());
    for (Eigen::Index j = 0; j < design.K.cols(); ++j) json["k"].back().push_back(design.K(i, j));
  }
  json["gains"] = options.output.string();
  return json;
}

void PrintText(const Design& design, const std::filesystem::path& file) {
  std::printf("%-34s %12s  %s\n", "check", "value", "must be");
  for (const DesignCheck& check : design.checks) {
    std::printf("%-34s %12.4g  %s %.4g%s\n", check.name.c_str(), check.value,
                check.below ? "below" : "above", check.limit, check.passed() ? "" : "   FAILED");
  }
  std::printf("\nK (N m per rad, per m, per rad/s, per m/s):\n");
  for (Eigen::Index i = 0; i < design.K.rows(); ++i) {
    for (Eigen::Index j = 0; j < design.K.cols(); ++j) std::printf(" %9.4g", design.K(i, j));
    std::printf("\n");
  }
  if (design.sound()) std::printf("\ngains written to %s\n", file.c_str());
}

void Write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text << '\n';
  out.close();
  if (!out) throw InputError(file.string() + ": cannot be written");
}

int Run(const Options& options) {
  Config config = options.config.Load();
  config.controller.gains_file.clear();  // a new design, whatever the config runs with
  const Design design = DesignController(config);
  const std::string hash = DesignHash(config);
  if (design.sound()) Write(options.output, DesignToJson(design, hash));
  if (options.json) {
    std::cout << ToJson(design, options, hash).dump(2) << '\n';
  } else {
    PrintText(design, options.output);
  }
  if (!design.sound()) {
    std::cerr << "flexarm: a check failed: no gains were written\n";
    return Exit::kFailed;
  }
  return Exit::kDone;
}

}  // namespace

void RegisterDesign(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "design", "Design reference model, gains and filter for a rig, check them, write them down");
  options->config.AddTo(verb, true);
  AddOutput(verb, &options->output, "Gains file to write (JSON)");
  AddJson(verb, &options->json);
  verb->footer(
      "Every check is printed with its figure; gains that fail one are not written.\n"
      "Run with them by [controller] gains = \"FILE\"; without that, the daemon designs at start.\n"
      "Example: flexarm design -c config/thesis-rig.toml -o gains.json");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
