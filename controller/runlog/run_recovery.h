#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

namespace flexarm {

/// What became of a run that a killed program left.
struct Recovery {
  enum class Result {
    kRecovered,  ///< it is a closed run now
    kClosed,     ///< it was one
    kWritten,    ///< a program writes it
    kEmpty,      ///< reserved for a run that never began
    kFailed,     ///< the file is as it was
  };
  Result result;
  std::string text;  ///< with the file's name
};

/// Turns a record file that no program writes into a closed run. Of a damaged one, the part before
/// the damage becomes the run, and the file is kept as "<file>.damaged".
Recovery RecoverRun(const std::filesystem::path& file) noexcept;

/// Recovers every "*.flexarm" in a directory, and removes what killed programs left of reserved and
/// half converted files. A directory that is missing has none.
///
/// A second for each ten minutes of recorded time, about. Thread: any; not real-time safe.
/// @param report  for the journal: what was recovered, and as errors what could not be
/// @param stop  leaves the rest for the next time
void RecoverRuns(const std::filesystem::path& directory,
                 const std::function<void(bool is_error, const std::string& text)>& report,
                 const std::stop_token& stop = {}) noexcept;

}  // namespace flexarm
