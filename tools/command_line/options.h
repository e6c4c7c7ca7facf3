#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/files/write_file.h"
#include "controller/types/law_table.h"

namespace CLI {
class App;
}

namespace flexarm {

/// The options -c/--config FILE and --set section.key=VALUE of every verb that reads a config.
struct ConfigOptions {
  std::filesystem::path file;
  std::vector<std::string> overrides;

  void AddTo(CLI::App* verb, bool required);
  bool given() const { return !file.empty(); }
  /// @throws ConfigError; InputError if --set was given without --config
  RigConfig Load() const;
};

/// The options --shard I/N and --jobs J of every verb that runs the points of a grid.
struct GridOptions {
  std::string shard = "1/1";  ///< text for ParseShard
  std::size_t jobs = 0;       ///< runs at a time; 0: one a core

  void AddTo(CLI::App* verb);
};

/// Adds --set section.key=VALUE alone, to a verb that names its config in another way.
void AddSet(CLI::App* verb, std::vector<std::string>* overrides);

/// The folder experiments/ that has `file`: beside the config, in config/ of the current folder,
/// where this program was installed, or in the source tree that it was built in.
/// @throws InputError if there is none
std::filesystem::path ExperimentsFolder(const std::filesystem::path& config,
                                        const std::string& file);

/// What a verb runs.
struct ChosenExperiment {
  std::filesystem::path file;
  Experiment experiment;
};

/// The experiment of the file `given`. If that is empty, the default of ExperimentsFolder,
/// square-30deg.toml or for a law that follows moves only moves.toml, fitted to the rig
/// (FitExperiment); tells on stderr what was fitted.
/// @throws ConfigError, InputError
ChosenExperiment ChooseExperiment(const std::filesystem::path& given,
                                  const std::filesystem::path& config_file,
                                  const RigConfig& config);

/// Check of a numeric option: low <= value <= high. Unlike CLI::Range it refuses a NaN.
std::function<std::string(const std::string&)> NumberWithin(double low, double high);

/// Adds --json: one JSON object on stdout and nothing else.
void AddJson(CLI::App* verb, bool* json);

/// Tells on stderr that a file was written.
void ReportWritten(const std::filesystem::path& file);

/// @throws InputError unless the file is a .png or a .svg that the rules permit to write
void CheckPicture(const std::filesystem::path& output, const OutputRules& rules);

/// The options -o/--output and --overwrite of a verb that writes a file or a folder.
struct OutputOptions {
  std::filesystem::path file;
  bool overwrite = false;

  /// @param type  "FILE" or "DIR"
  void AddTo(CLI::App* verb, const std::string& what, bool required, const char* type = "FILE");
  bool given() const { return !file.empty(); }
  /// Rules for a file that the verb writes and that it knows by `mark`.
  OutputRules Rules(const char* kind, const char* mark,
                    std::vector<std::filesystem::path> inputs) const;
};

/// Adds -o/--output FILE.
void AddOutput(CLI::App* verb, std::filesystem::path* file, const std::string& what);

}  // namespace flexarm
