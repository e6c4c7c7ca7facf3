#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace flexarm {

/// A made-up /proc, /sys, /dev and /etc in a temporary folder.
class HostTree {
 public:
  HostTree() {
    std::string name = std::filesystem::temp_directory_path() / "flexarm-host-XXXXXX";
    root_ = mkdtemp(name.data());
  }
  ~HostTree() { std::filesystem::remove_all(root_); }
  HostTree(const HostTree&) = delete;
  HostTree& operator=(const HostTree&) = delete;

  const std::filesystem::path& root() const { return root_; }

  void Write(const std::string& path, const std::string& text) const {
    const std::filesystem::path file = At(path);
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
  }

  /// A relative link, as those of sysfs.
  void Link(const std::string& path, const std::string& target) const {
    const std::filesystem::path link = At(path);
    std::filesystem::create_directories(link.parent_path());
    std::filesystem::create_directories(At(target));
    std::filesystem::create_symlink(std::filesystem::relative(At(target), link.parent_path()),
                                    link);
  }

  void Remove(const std::string& path) const { std::filesystem::remove_all(At(path)); }

  /// A thread of the kernel for an interrupt, as process `pid`.
  void InterruptThread(int pid, const std::string& comm, int priority) const {
    const std::string process = "/proc/" + std::to_string(pid);
    Write(process + "/comm", comm + "\n");
    // State and the 36 fields after it, the priority, the policy.
    std::string stat = std::to_string(pid) + " (" + comm + ") S";
    for (int i = 0; i < 36; ++i) stat += " 7";
    Write(process + "/stat", stat + " " + std::to_string(priority) + " 1 0 0\n");
  }

 private:
  std::filesystem::path At(const std::string& path) const { return root_ / path.substr(1); }

  std::filesystem::path root_;
};

}  // namespace flexarm
