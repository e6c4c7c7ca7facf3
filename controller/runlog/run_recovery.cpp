#include "controller/runlog/run_recovery.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <vector>

#include "controller/runlog/append_file.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/runlog/reserved_run_file.h"
#include "controller/runlog/run_conversion.h"
#include "controller/runlog/run_file_lock.h"

namespace flexarm {
namespace {

constexpr std::string_view kRunSuffix = ".flexarm";
constexpr std::string_view kPartSuffix = ".flexarm.part";

bool IsRecordFile(int fd) {
  std::string magic(kRecordMagic.size(), '\0');
  const ssize_t count = ::pread(fd, magic.data(), magic.size(), 0);
  return count == static_cast<ssize_t>(magic.size()) && magic == kRecordMagic;
}

std::string RecoveredText(const std::filesystem::path& file, const RecordFileEnd& end) {
  std::string text = file.string() + ": " + (end.ended ? "closed" : "recovered");
  if (end.damaged_at) {
    text += " up to damage at byte " + std::to_string(*end.damaged_at) + "; all of it is kept as " +
            DamagedNameOf(file).filename().string();
  } else if (end.left_out_bytes > 0) {
    text += "; " + std::to_string(end.left_out_bytes) +
            " bytes after the last whole record are left out";
  }
  return text;
}

Recovery RecoverOpened(const std::filesystem::path& file, int fd) {
  using Result = Recovery::Result;
  const std::string name = file.string();
  struct stat there{};
  if (::fstat(fd, &there) != 0 || !S_ISREG(there.st_mode)) {
    return {Result::kFailed, name + ": not a regular file; expected a run log (.flexarm)"};
  }
  if (!LockRunFile(fd)) return {Result::kWritten, name + ": a program is writing this run"};
  if (!NamesFile(file, fd)) return {Result::kClosed, name + ": was closed just now"};
  if (there.st_size == 0) return {Result::kEmpty, name + ": is empty: no run began in it"};
  if (!IsRecordFile(fd)) return {Result::kClosed, name + ": nothing to recover: no record file"};
  return {Result::kRecovered, RecoveredText(file, ConvertRecordFile(fd, file))};
}

std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& directory,
                                           std::string_view suffix) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(directory, ignored)) {
    if (entry.path().filename().string().ends_with(suffix)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// ".run.flexarm.part" is half of "run.flexarm", which was not touched.
void RemovePart(const std::filesystem::path& part) {
  const std::string name = part.filename().string();
  const std::size_t length = name.size() - std::strlen(".part");
  const std::filesystem::path file = part.parent_path() / name.substr(1, length - 1);
  if (!RunFileIsLocked(part) && !RunFileIsLocked(file)) ::unlink(part.c_str());
}

// Of a killed program: no run began in it.
void RemoveReserved(const std::filesystem::path& file) {
  if (file.filename().string().starts_with(".next-") && !RunFileIsLocked(file)) {
    ::unlink(file.c_str());
  }
}

}  // namespace

Recovery RecoverRun(const std::filesystem::path& file) noexcept {
  try {
    // For writing, because a lock needs it. A FIFO does not make it wait.
    const FileDescriptor fd(::open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    if (fd.is_open()) return RecoverOpened(file, fd.get());
    return {Recovery::Result::kFailed, file.string() + ": " + std::strerror(errno)};
  } catch (const std::exception& error) {
    return {Recovery::Result::kFailed, error.what()};
  }
}

void RecoverRuns(const std::filesystem::path& directory,
                 const std::function<void(bool is_error, const std::string& text)>& report,
                 const std::stop_token& stop) noexcept {
  try {
    for (const std::filesystem::path& file : FilesIn(directory, kRunSuffix)) {
      if (stop.stop_requested()) return;
      const Recovery recovery = RecoverRun(file);
      if (recovery.result == Recovery::Result::kRecovered) report(false, "run " + recovery.text);
      if (recovery.result == Recovery::Result::kFailed) report(true, "run " + recovery.text);
      if (recovery.result == Recovery::Result::kEmpty) ::unlink(file.c_str());
    }
    for (const std::filesystem::path& part : FilesIn(directory, kPartSuffix)) RemovePart(part);
    for (const std::filesystem::path& file : FilesIn(directory, kReservedSuffix)) {
      RemoveReserved(file);
    }
  } catch (const std::exception&) {  // no memory for a list or a line: the next start tries again
  }
}

}  // namespace flexarm
