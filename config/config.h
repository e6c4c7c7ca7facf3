#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/types/experiment.h"
#include "controller/types/rig_config.h"

namespace flexarm {

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

/// Reads a rig from one TOML file and the files that it extends. No key has a default but [hal],
/// [csv] and controller.gains.
///
/// Reads `file`, what it extends, and `overrides` ("section.key=VALUE", TOML syntax, a bare word is
/// a string; last wins). A row or element is named by its number: "sensors.strain[3].face=-1".
/// @throws ConfigError with every problem found
RigConfig LoadConfig(const std::filesystem::path& file,
                     const std::vector<std::string>& overrides = {});

/// The same from text, as a run log holds it: `extends` is refused. `name` stands for the file in
/// messages.
RigConfig ParseConfig(const std::string& text, const std::string& name);

/// The same rig with other values, in the form of --set: a search over parameters asks for many.
/// @throws ConfigError with every problem found
RigConfig WithOverrides(const RigConfig& config, const std::vector<std::string>& overrides);

/// The number that stands at a dotted key of the config, "sensors.strain[3].position_m".
std::optional<double> NumberAt(const RigConfig& config, const std::string& key);

/// Reads what one run does. Whether the arm may do it (its soft limits) is judged by who runs it.
/// @throws ConfigError with every problem found
Experiment LoadExperiment(const std::filesystem::path& file);
Experiment ParseExperiment(const std::string& text, const std::string& name);

}  // namespace flexarm
