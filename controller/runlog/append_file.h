#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "controller/runlog/file_descriptor.h"

namespace flexarm {

/// A file that only grows, and loses nothing while its disk fails for a while.
///
/// What is appended waits in memory for Flush, which writes it with one call. What a full, removed
/// or broken disk does not take stays in memory for the next Flush. A file that was removed or
/// renamed is made again under its name, from the file that is still open.
/// Thread: one at a time. Not real-time safe: Flush waits for the disk.
class AppendFile {
 public:
  /// @param fd  empty, open for reading and writing, locked (run_file_lock.h)
  AppendFile(std::filesystem::path path, FileDescriptor fd);

  void Append(std::string_view bytes) { pending_.append(bytes); }

  /// @returns true if the file has everything that was appended; Trouble() then is empty
  bool Flush() noexcept;
  /// Flushes, gives back what was reserved beyond the end, and waits until the disk has it.
  bool Sync() noexcept;

  /// Why the last Flush or Sync did not write everything, for the operator; "" if it did.
  const std::string& trouble() const { return trouble_; }
  std::uint64_t size() const { return written_ + pending_.size(); }  ///< offset of the next byte
  std::size_t pending_bytes() const { return pending_.size(); }

  /// Changes only if the file was removed and its name taken by another file.
  const std::filesystem::path& path() const { return path_; }
  int fd() const { return fd_.get(); }

 private:
  bool Fail(const char* what, int error);
  bool KeepName();
  bool MakeAgain();

  std::filesystem::path path_;
  FileDescriptor fd_;
  std::uint64_t written_ = 0;
  std::string pending_;
  std::string trouble_;
};

/// "<folder>/.<name>.part": what is written there becomes `file` by a rename.
std::filesystem::path PartOf(const std::filesystem::path& file);

/// Waits until the disk has the names in a directory. @returns 0, or errno
int SyncDirectory(const std::filesystem::path& directory);

}  // namespace flexarm
