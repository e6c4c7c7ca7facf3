#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace flexarm {

/// Which existing file a verb may replace.
struct OutputRules {
  const char* kind;  ///< what it writes, in messages: "a gains file"
  /// Text with which flexarm begins every file of this kind, or which such a file has among its
  /// first 4 KiB: a file with it is replaced. Empty: none is known by its text.
  std::string mark;
  /// Files that the verb reads: never written, whatever else is said. Files that do not exist are
  /// left out of account.
  std::vector<std::filesystem::path> inputs;
  bool overwrite = false;  ///< --overwrite: replace whatever regular file is there
};

/// Whether WriteFile would accept this place. For a verb to ask before minutes of work.
/// @throws InputError "file: .., expected .."
void CheckOutput(const std::filesystem::path& file, const OutputRules& rules);

/// Writes a file, whole or not at all (ReplaceFile). A link stays; the file that it leads to is
/// replaced and keeps its permissions.
/// @throws InputError with the file and the system's cause; or if the file exists and the rules do
///   not allow to replace it; a device, a FIFO or a directory is always refused
void WriteFile(const std::filesystem::path& file, std::string_view text, const OutputRules& rules);

/// Rules for a file of this kind in a folder whose files may be replaced.
OutputRules ReplaceAny(const char* kind);

/// Creates a folder, and those above it. @throws InputError with the system's cause
void MakeFolder(const std::filesystem::path& folder);

/// Creates a folder for several files of output. @throws InputError the same; or if the folder has
/// files already and `overwrite` is not set
void MakeOutputFolder(const std::filesystem::path& folder, bool overwrite);

}  // namespace flexarm
