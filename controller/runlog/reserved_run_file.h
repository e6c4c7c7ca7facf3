#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "controller/runlog/errors.h"
#include "controller/runlog/file_descriptor.h"

namespace flexarm {

/// The name of a reserved file ends so, until its run begins: it is no run yet.
inline constexpr std::string_view kReservedSuffix = ".reserved";

/// An empty file for a run: created, locked (run_file_lock.h), and with space reserved where the
/// file system can. RunWriter writes the run into it. Removed at the end if no run took it.
///
/// A killed process leaves it empty: RecoverRuns removes it.
/// Thread: one at a time. Not real-time safe.
class ReservedRunFile {
 public:
  ReservedRunFile() = default;
  ~ReservedRunFile();
  ReservedRunFile(ReservedRunFile&& other) noexcept;
  ReservedRunFile& operator=(ReservedRunFile&& other) noexcept;

  /// A file in `directory`, which is created if missing, with a hidden name until Rename.
  /// @param bytes  to reserve, so that a disk that fills later does not stop the run
  /// @throws RunLogError that names directory and cause
  static ReservedRunFile In(const std::filesystem::path& directory, std::uint64_t bytes);

  /// A file with its final name. Its folder is created if missing.
  /// @throws RunLogError, also if the name is taken
  static ReservedRunFile At(const std::filesystem::path& name);

  /// Gives it its final name, in the same directory.
  /// @throws RunLogError if that is taken, or cannot be given; the old name then holds
  void Rename(const std::filesystem::path& file);

  /// False: moved from, or taken by a run.
  bool is_valid() const { return fd_.is_open(); }
  const std::filesystem::path& path() const { return path_; }

  /// The open file, for the run that takes it. It is then no longer removed.
  FileDescriptor Take();

 private:
  ReservedRunFile(std::filesystem::path path, FileDescriptor fd);
  void Remove();

  std::filesystem::path path_;
  FileDescriptor fd_;
};

/// Bytes that an unprivileged process may still write there; empty if that cannot be asked.
std::optional<std::uint64_t> FreeBytes(const std::filesystem::path& directory);

/// Renames within a directory, and never replaces a file. @returns 0, or errno: EEXIST
int RenameToNewName(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace flexarm
