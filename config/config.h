#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/law/experiment.h"
#include "controller/runtime/stack_config.h"

namespace flexarm {

/// A rig, read from one TOML file and the files that it extends.
struct Config : StackConfig {
  std::string rig_name;  ///< key rig.name
  std::string backend;   ///< key hal.backend: "sim", or "" when the file has no [hal]
  /// The merged, overridden document as TOML: reading it again gives the same Config. Logged.
  std::string text;
};

/// One thing wrong with a file, and where.
struct ConfigProblem {
  std::string file;
  int line;  ///< 1-based; 0 if there is no line (a missing key, an override)
  std::string key;
  std::string value;
  std::string rule;

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
/// a string; last wins).
/// @throws ConfigError with every problem found
Config LoadConfig(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text, as a run log holds it. `name` stands for the file in messages.
Config ParseConfig(const std::string& text, const std::string& name);

/// @throws ConfigError
Experiment LoadExperiment(const std::filesystem::path& file);
Experiment ParseExperiment(const std::string& text, const std::string& name);

}  // namespace flexarm
