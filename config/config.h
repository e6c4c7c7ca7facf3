#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/law/experiment.h"
#include "controller/runlog/csv_import.h"
#include "controller/runtime/stack_config.h"

namespace flexarm {

/// A rig, read from one TOML file and the files that it extends.
///
/// Each struct belongs to the folder that uses it and owns its rules; here are the files, the keys
/// and the rules between the structs. No key has a default but [hal], [csv] and controller.gains.
struct Config : StackConfig {
  std::string rig_name;  ///< key rig.name
  std::string backend;   ///< key hal.backend: "sim", "wired", or "" when the file has no [hal]
  /// The merged, overridden document as TOML: reading it again gives the same Config. Logged.
  std::string text;
  std::optional<CsvImport> csv;  ///< table [csv]: how to read what another recorder wrote
};

/// One thing wrong with a file, and where: the file in which the value really stands, which may be
/// one that the named file extends; "--set" for an override.
struct ConfigProblem {
  std::string file;
  int line;  ///< 1-based; of the table if a key is missing; 0 if there is no line (an override)
  std::string key;    ///< dotted, rows counted from 0: "sensors.strain[3].position_m"; may be empty
  std::string value;  ///< as TOML; empty if there is none
  std::string rule;   ///< what was expected

  /// "thesis-rig.toml:14: loop.period_ms = 0: must be ..."
  std::string Text() const;
};

/// Everything wrong with a file at once; what() has one line a problem.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<ConfigProblem> problems);
  const std::vector<ConfigProblem>& problems() const { return problems_; }

 private:
  std::vector<ConfigProblem> problems_;
};

/// Reads `file`, what it extends, and `overrides` ("section.key=VALUE", TOML syntax, a bare word is
/// a string; last wins). A row or element is named by its number: "sensors.strain[3].face=-1".
/// @throws ConfigError with every problem found
Config LoadConfig(const std::filesystem::path& file,
                  const std::vector<std::string>& overrides = {});

/// The same from text, as a run log holds it: `extends` is refused. `name` stands for the file in
/// messages.
Config ParseConfig(const std::string& text, const std::string& name);

/// The same rig with other values, in the form of --set: a search over parameters asks for many.
/// @throws ConfigError with every problem found
Config WithOverrides(const Config& config, const std::vector<std::string>& overrides);

/// The number that stands at a dotted key of the config, "sensors.strain[3].position_m".
std::optional<double> NumberAt(const Config& config, const std::string& key);

/// Reads what one run does. Whether the arm may do it (its soft limits) is judged by who runs it.
/// @throws ConfigError with every problem found
Experiment LoadExperiment(const std::filesystem::path& file);
Experiment ParseExperiment(const std::string& text, const std::string& name);

}  // namespace flexarm
