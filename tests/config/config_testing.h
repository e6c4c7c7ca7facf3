#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/config.h"

namespace flexarm {

/// The shipped file config/`name`.
inline std::filesystem::path Shipped(const std::string& name) {
  return std::filesystem::path(FLEXARM_SOURCE_DIR) / "config" / name;
}

/// The shipped simulated rig with `overrides`.
inline RigConfig HilWith(const std::vector<std::string>& overrides) {
  return LoadConfig(Shipped("hil.toml"), overrides);
}

inline std::string FileText(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error("no file " + file.string());
  return text.str();
}

/// 1-based line of the end of the first `part` in `text`; 0 if `text` does not contain it.
inline int LineOf(const std::string& text, const std::string& part) {
  const std::size_t at = text.find(part);
  if (at == std::string::npos) return 0;
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(at + part.size());
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

/// `text` with its first `from` replaced. Throws if there is none, because the test would then
/// check nothing.
inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("not in the file: " + from);
  return text.replace(at, from.size(), to);
}

/// The problems reported by `action`; empty if there are none.
template <typename Action>
std::vector<ConfigProblem> ProblemsFrom(const Action& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

/// The problems of a rig's text.
inline std::vector<ConfigProblem> ProblemsOf(const std::string& text) {
  return ProblemsFrom([&] { ParseConfig(text, "rig.toml"); });
}

/// An empty folder for the files of one test, deleted afterwards.
class TempFolder {
 public:
  TempFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("flexarm_config_") + test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace flexarm
