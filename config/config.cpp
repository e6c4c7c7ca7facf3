#include "config/config.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "config/cross_rules.h"
#include "config/derived_keys.h"
#include "config/document.h"
#include "config/overrides.h"
#include "config/problem_log.h"
#include "config/rig_binding.h"
#include "config/section_rules.h"
#include "config/table_reader.h"
#include "config/toml_text.h"
#include "controller/runlog/csv_import.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

// The length of a link if it was read; otherwise NaN, which violates no rule.
double KnownLength(const RigConfig& config, std::size_t link, const ProblemLog& log) {
  const std::string section = "link" + NumberText(link + 1) + ".section";
  return log.Clear({section}) ? config.arm.link[link].length_m()
                              : std::numeric_limits<double>::quiet_NaN();
}

void CheckRules(const RigConfig& config, ProblemLog* log) {
  for (const std::vector<Problem>& problems : RulesOfArm(config)) log->AddRules(problems);
  const std::array<double, 2> length_m = {KnownLength(config, 0, *log),
                                          KnownLength(config, 1, *log)};
  for (const std::vector<Problem>& problems : RulesOfRest(config, length_m)) {
    log->AddRules(problems);
  }
  if (config.csv && log->Clear({"sensors"})) log->AddRules(ProblemsOf(*config.csv, config.sensors));
  CheckCrossRules(config, log);
}

RigConfig ReadConfig(const std::string& name, toml::table document,
                     const std::vector<std::string>& overrides) {
  ProblemLog log(name, &document);
  ApplyOverrides(overrides, &document, &log);
  log.Excuse(AddDerivedKeys(&document).waiting);
  TableReader root(&document, "", &log);
  if (root.Has(kExtendsKey)) {
    root.Refuse(
        kExtendsKey,
        "must be in a config file: neither the config text of a log nor --set can extend a file");
  }
  RigConfig config{};
  ReadRig(root, &config);
  CheckRules(config, &log);
  log.AddUnknown();
  log.ThrowIfAny();
  config.text = DocumentText(document);
  return config;
}

}  // namespace

std::vector<std::vector<Problem>> RulesOfArm(const RigConfig& config) {
  ProblemList rig("rig.");
  rig.Require(!config.rig_name.empty(), "name", "\"\"",
              "must name the rig: the logs contain the name");
  return {rig.Take(), config.arm.Problems()};
}

std::vector<std::vector<Problem>> RulesOfRest(const RigConfig& config,
                                              const std::array<double, 2>& link_length_m) {
  return {config.sensors.Problems(link_length_m),
          config.sim.Problems(),
          config.estimator.Problems(),
          config.controller.Problems(),
          config.safety.Problems(),
          config.commissioning.Problems(),
          config.loop.Problems(),
          config.daemon.Problems(),
          config.telemetry.Problems(),
          config.hal.Problems({.sensors = config.sensors,
                               .available_ns = std::llround(config.loop.acquire_before_ms * 1e6),
                               .torque_limit_nm = config.safety.torque_limit_nm})};
}

RigConfig LoadConfig(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return ReadConfig(file.string(), LoadDocument(file), overrides);
}

RigConfig ParseConfig(const std::string& text, const std::string& name) {
  return ReadConfig(name, ParseToml(text, name), {});
}

RigConfig WithOverrides(const RigConfig& config, const std::vector<std::string>& overrides) {
  return ReadConfig(config.rig_name, ParseToml(config.text, config.rig_name), overrides);
}

RigConfig WithLaw(const RigConfig& config, const std::string& law) {
  return WithOverrides(config, {"controller.name=" + law});
}

std::optional<double> NumberAt(const RigConfig& config, const std::string& key) {
  const toml::table document = ParseToml(config.text, config.rig_name);
  const toml::node_view<const toml::node> node = document.at_path(key);
  return node.is_number() ? node.value<double>() : std::nullopt;
}

}  // namespace flexarm
