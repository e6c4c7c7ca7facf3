#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace flexarm {

/// Contents of a file of the host.
struct HostText {
  enum class State : std::uint8_t {
    kRead,
    kAbsent,      ///< there is no such file
    kUnreadable,  ///< it exists, and cannot be read
  };
  State state;
  std::string text;  ///< without white space at its end

  bool read() const noexcept { return state == State::kRead; }
  bool absent() const noexcept { return state == State::kAbsent; }
  /// The whole text as a decimal number, if it is one.
  std::optional<std::int64_t> number() const;
};

/// Reads files of the kernel below a root folder: "/", or a made-up tree in a test, whose symbolic
/// links must be relative. Not real-time safe.
class HostFiles {
 public:
  explicit HostFiles(std::filesystem::path root = "/") : root_(std::move(root)) {}

  /// @param path  absolute: "/proc/self/status"
  HostText Read(const std::string& path) const;

  /// Sorted names in a folder; empty if it cannot be read.
  std::vector<std::string> List(const std::string& folder) const;

  /// `path` with all links followed; empty if there is no such file.
  std::string Resolve(const std::string& path) const;

 private:
  std::filesystem::path At(const std::string& path) const { return root_ / path.substr(1); }

  std::filesystem::path root_;
};

/// The numbers of a list like "0-2,5"; nothing for a text of another form.
std::optional<std::vector<int>> NumbersOfList(const std::string& text);

}  // namespace flexarm
