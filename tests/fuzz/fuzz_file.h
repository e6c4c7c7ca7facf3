#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace flexarm {

/// A file of this process, in memory where the machine has a folder for that, for code that reads
/// files only. It is removed, with its folder, when the process ends in order.
class FuzzFile {
 public:
  explicit FuzzFile(const std::string& name);
  ~FuzzFile();
  FuzzFile(const FuzzFile&) = delete;
  FuzzFile& operator=(const FuzzFile&) = delete;

  /// Nothing else stays in the folder.
  void Write(std::string_view bytes) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace flexarm
