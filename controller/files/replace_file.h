#pragma once

#include <string>
#include <string_view>

namespace flexarm {

/// Result of a change of a file.
struct FileChange {
  std::string problem;  ///< what and the system's cause; empty: done, and a power failure keeps it
  bool untouched = false;  ///< the file is surely as before
};

/// A file that is to be replaced, in a folder that is open.
struct ReplacedFile {
  int folder;            ///< descriptor
  std::string name;      ///< within the folder
  std::string part;      ///< the temporary file beside it; what an interrupted call left is reused
  unsigned mode = 0644;  ///< permissions of the new file
  bool without_umask = false;  ///< the umask of the process takes nothing from `mode`
};

/// Replaces a file, or creates it: temporary file, sync, rename, sync of the folder. After an
/// interruption at any instant the file is the old one or the new one, whole.
/// Waits for the disk. Not real-time safe.  Thread: any; one at a time for one file.
FileChange ReplaceFile(const ReplacedFile& file, std::string_view text);

}  // namespace flexarm
