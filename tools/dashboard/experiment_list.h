#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flexarm {

/// The experiments that a page offers: the files *.toml of one folder. A browser names one of them
/// and never a path. Not real-time safe.
class ExperimentList {
 public:
  static constexpr std::size_t kMost = 500;  ///< further ones are not offered

  /// @param folder  empty: there is none, and no experiments
  explicit ExperimentList(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Names of the files, sorted.
  std::vector<std::string> Names() const;

  /// Whole text of an experiment, with what it includes. @throws InputError: it is not one of
  /// Names(); ConfigError: the file is wrong
  std::string TextOf(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace flexarm
