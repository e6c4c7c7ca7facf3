#pragma once

#include <filesystem>

namespace flexarm {

/// A folder of a new name. It and all that is in it are gone when this object is.
class ScratchFolder {
 public:
  /// @param parent  a folder that exists
  /// @throws std::runtime_error  naming it and the cause, if none can be made
  explicit ScratchFolder(
      const std::filesystem::path& parent = std::filesystem::temp_directory_path());
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace flexarm
