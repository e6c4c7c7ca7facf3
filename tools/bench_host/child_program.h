#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace flexarm {

/// What a program did.
struct ProgramResult {
  int exit_code;       ///< 128 + the signal if one ended it
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

/// Whether `name` is an executable file of a folder in PATH.
bool IsInPath(const std::string& name);

/// Runs a program to its end, in `folder`, with nothing to read.
/// @param words  the program, by its path or to be found in PATH, and its arguments
/// @throws std::runtime_error if it cannot be started
ProgramResult RunChild(const std::vector<std::string>& words, const std::filesystem::path& folder);

/// A program that runs in the background, in a folder, until this object ends; also if this process
/// is killed before.
class BackgroundChild {
 public:
  /// As RunChild.
  BackgroundChild(const std::vector<std::string>& words, const std::filesystem::path& folder);
  /// Asks it to end (SIGTERM), and kills it after 5 s.
  ~BackgroundChild();
  BackgroundChild(const BackgroundChild&) = delete;
  BackgroundChild& operator=(const BackgroundChild&) = delete;

  /// @throws std::runtime_error if it has ended, with its reason
  void RequireRunning();

 private:
  bool HasEnded();

  std::string name_;
  std::filesystem::path folder_;
  pid_t child_ = 0;
  bool ended_ = false;
  int status_ = 0;
};

/// The last line of what it said on standard error that is not empty, or its exit code: for why it
/// failed.
std::string ReasonOf(const ProgramResult& result);

}  // namespace flexarm
