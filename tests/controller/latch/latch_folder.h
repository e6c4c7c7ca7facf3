#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace flexarm {

/// A state folder of one test, in memory where the machine has a folder for that, because every
/// write is synced. It is not made before the first use.
class LatchFolder {
 public:
  LatchFolder() {
    const bool in_memory = std::filesystem::is_directory("/dev/shm");
    std::string name = in_memory ? "/dev/shm/flexarm-XXXXXX" : "/tmp/flexarm-XXXXXX";
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    top_ = name;
  }
  ~LatchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(top_, ignored);
  }
  LatchFolder(const LatchFolder&) = delete;
  LatchFolder& operator=(const LatchFolder&) = delete;

  std::filesystem::path path() const { return top_ / "state"; }
  std::filesystem::path file(const std::string& name) const { return path() / name; }

  void Put(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(path());
    std::ofstream(file(name)) << text;
  }
  std::string Text(const std::string& name) const {
    std::ifstream stream(file(name));
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  bool Has(const std::string& name) const {
    return std::filesystem::exists(std::filesystem::symlink_status(file(name)));
  }

 private:
  std::filesystem::path top_;
};

/// While it lives, no file of this process may grow: every write fails, as on a full disk.
class FullDisk {
 public:
  FullDisk() {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit none{.rlim_cur = 0, .rlim_max = limit_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit limit_{};
  void (*before_)(int) = nullptr;
};

}  // namespace flexarm
