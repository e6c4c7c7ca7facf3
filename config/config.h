#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/types/experiment.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// A problem of a config, with its place: the file that contains the value, which may be one that
/// the named file extends; "--set" for an override.
struct ConfigProblem {
  std::string file;
  int line;  ///< 1-based; the line of the table if a key is missing; 0 for an override, which has
             ///< no line
  std::string key;  ///< dotted, rows numbered from 0: "sensors.strain[3].position_m"; may be empty
  std::string value;  ///< as TOML; empty if there is none
  std::string rule;   ///< the rule that the value violates

  /// "thesis-rig.toml:14: loop.period_ms = 0: must be ..."
  std::string Text() const;
};

/// All problems of a config at once; what() has one line per problem.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<ConfigProblem> problems);
  const std::vector<ConfigProblem>& problems() const { return problems_; }

 private:
  std::vector<ConfigProblem> problems_;
};

/// Reads a rig from one TOML file and the files that it extends.
///
/// The tuning keys of DerivableKeys (config/derivation/derivation.h) may be left out, and follow
/// the arm then. Of the others none has a default, but [hal], [csv], controller.gains and those
/// that thesis-rig.toml shows as comments. Reads `file`, what it extends, and `overrides`
/// ("section.key=VALUE", TOML syntax, a bare word is a string; last wins). A row or element is
/// named by its number: "sensors.strain[3].face=-1".
/// @throws ConfigError with every problem found
RigConfig LoadConfig(const std::filesystem::path& file,
                     const std::vector<std::string>& overrides = {});

/// Reads the text of a config, such as the one in a run log: `extends` is refused. `name` stands
/// for the file in messages.
RigConfig ParseConfig(const std::string& text, const std::string& name);

/// The config with other values, in the form of --set; fast enough for searches over parameters.
/// @throws ConfigError with every problem found
RigConfig WithOverrides(const RigConfig& config, const std::vector<std::string>& overrides);

/// The config with another control law, controller.name. @throws ConfigError
RigConfig WithLaw(const RigConfig& config, const std::string& law);

/// The number at a dotted key of the config, "sensors.strain[3].position_m".
std::optional<double> NumberAt(const RigConfig& config, const std::string& key);

/// Reads the experiment of one run. Its limits (soft limits, torque) are checked when it is loaded
/// into a run, not here.
/// @throws ConfigError with every problem found
Experiment LoadExperiment(const std::filesystem::path& file);
Experiment ParseExperiment(const std::string& text, const std::string& name);

}  // namespace flexarm
