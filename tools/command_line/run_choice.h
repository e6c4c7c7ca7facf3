#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace flexarm {

/// Which run logs a verb reads: the files given, or with --last the newest of --folder DIR.
class RunChoice {
 public:
  /// Argument RUN.
  void AddTo(CLI::App* verb, const char* what = "Run log", const char* type = "RUN");
  /// Arguments RUN...
  void AddManyTo(CLI::App* verb);

  /// Option `name` RUN, such as "--like", in place of an argument.
  void AddOptionTo(CLI::App* verb, const std::string& name, const std::string& what);

  /// A run was named, or --last was given.
  bool given() const { return last_ || !files_.empty(); }

  /// @throws InputError: none was given, or the folder has none
  std::filesystem::path File() const { return Files().front(); }
  std::vector<std::filesystem::path> Files() const;

 private:
  void AddLast(CLI::App* verb);

  std::vector<std::filesystem::path> files_;
  bool last_ = false;
  std::filesystem::path folder_ = "runs";
};

/// Adds --folder DIR, where the run logs are: as shipped, log.directory is "runs".
void AddRunFolder(CLI::App* verb, std::filesystem::path* folder);

}  // namespace flexarm
