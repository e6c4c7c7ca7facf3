#pragma once

#include <filesystem>

namespace flexarm {

// The mark of a run that is being written: a lock on its file, which ends with the process. It
// belongs to the open file description, so another thread of the same process sees it, too.

/// Locks an open file for writing. @returns false if another open file holds the lock
bool LockRunFile(int fd);

/// True if another open file holds the lock: the run goes on, or is being ended.
bool RunFileIsLocked(int fd);

/// The same of a file by name; false if it cannot be opened.
bool RunFileIsLocked(const std::filesystem::path& file);

/// True if the name still means the open file.
bool NamesFile(const std::filesystem::path& file, int fd);

}  // namespace flexarm
