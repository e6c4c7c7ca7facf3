#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "controller/files/replace_file.h"

namespace flexarm {

/// Text of a file, or why there is none. Both empty: there is no such file.
struct FileText {
  std::optional<std::string> text;
  std::string problem;  ///< the file may exist, but what it says is not known
};

/// The daemon's state folder: small files that survive crash and power failure whole. One process
/// at a time: a lock on the folder, which the kernel releases however the process ends.
///
/// Not real-time safe: waits for the disk. Thread: one.
class StateFolder {
 public:
  /// Creates the folder if there is none.
  /// @throws RejectedError if it cannot be created or opened, or another process has locked it
  explicit StateFolder(const std::filesystem::path& folder);
  ~StateFolder();
  StateFolder(const StateFolder&) = delete;
  StateFolder& operator=(const StateFolder&) = delete;

  /// A file whose first writing was interrupted is a problem, not a missing file. So is a link.
  FileText Read(const std::string& name) const;

  /// Temporary file, sync, rename, sync of the folder: after an interruption the file is the old
  /// one or the new one, and Read does not report it as missing.
  FileChange Replace(const std::string& name, const std::string& text) const;

  /// Removes the file and what an interrupted Replace left. Done also if there is no such file.
  FileChange Remove(const std::string& name) const;

  /// For messages.
  std::string PathOf(const std::string& name) const { return (folder_ / name).string(); }

 private:
  std::filesystem::path folder_;
  int fd_ = -1;
};

}  // namespace flexarm
