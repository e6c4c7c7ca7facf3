#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace flexarm {

inline constexpr std::size_t kMiB = std::size_t{1} << 20U;

/// How a file of this kind is checked before anything else sees its text.
enum class FileSyntax : unsigned char { kToml, kJson, kCsv };

/// A kind of files that others may have written.
struct FileKind {
  const char* name;  ///< as in "expected NAME": "a config"
  std::size_t most_bytes;
  FileSyntax syntax;
};

// The daemon takes an experiment with its trajectory in one line of at most 1 MiB.
inline constexpr FileKind kConfigFile{"a TOML file", kMiB, FileSyntax::kToml};
inline constexpr FileKind kTrajectoryFile{"a CSV file of at most 512 KiB", kMiB / 2,
                                          FileSyntax::kCsv};
// Ten hours at 50 Hz, or half an hour of another recorder at 1 kHz.
inline constexpr FileKind kCsvFile{"a CSV file", 256 * kMiB, FileSyntax::kCsv};
inline constexpr FileKind kGainsFile{"a gains file", 16 * kMiB, FileSyntax::kJson};
inline constexpr FileKind kCalibrationFile{"a calibration", kMiB, FileSyntax::kJson};
inline constexpr FileKind kStateFile{"a file that the daemon wrote", kMiB / 16, FileSyntax::kJson};
inline constexpr FileKind kLinearSystemFile{"a linear system", 64 * kMiB, FileSyntax::kJson};

/// A rule that a file breaks.
struct FileProblem {
  int line = 0;  ///< 1-based; 0 if it concerns the whole file
  std::string what;
  bool missing = false;  ///< there is no such file

  /// "file: what" or "file:line: what"
  std::string Text(const std::filesystem::path& file) const;
};

/// Text of a file, or why there is none.
struct FileContent {
  std::string text;
  std::optional<FileProblem> problem;
};

/// Checks text that came from a file of this kind: UTF-8, no control characters, nesting.
std::optional<FileProblem> ProblemOfText(std::string_view text, const FileKind& kind);

/// The text without byte order mark, with line ends LF for CR LF or CR.
std::string PlainText(std::string text);

/// Reads a whole file and checks it: a regular file (what else is refused is named: a FIFO, a
/// device, a directory), no larger than its kind allows, ProblemOfText. The result is PlainText.
///
/// Waits for the disk, never for another process. Not real-time safe.  Thread: any.
FileContent ReadExternalFile(const std::filesystem::path& file, const FileKind& kind);

/// The same for a file that is open. @param fd  stays open; opened with O_NONBLOCK
FileContent ReadOpenFile(int fd, const FileKind& kind);

/// The same. @throws InputError "file:line: what"
std::string ReadExternalText(const std::filesystem::path& file, const FileKind& kind);

/// "a FIFO", "a device" .. for a st_mode.
const char* FileTypeName(unsigned mode);

/// What keeps `file` from being opened as a regular file; `expected`: "a run log (.flexarm)".
/// For files that a library opens by their name.
std::optional<FileProblem> ProblemOfPlace(const std::filesystem::path& file,
                                          const std::string& expected);

/// Up to `most_bytes` from the start of a regular file, unchecked; empty if it cannot be read.
std::string Beginning(const std::filesystem::path& file, std::size_t most_bytes);

}  // namespace flexarm
