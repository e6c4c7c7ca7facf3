#include "controller/latch/state_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "controller/files/external_file.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

constexpr const char* kAdvice =
    "; set daemon.state_directory, or --state-dir, to a folder that this user may write";

[[noreturn]] void Refuse(const std::filesystem::path& folder, const std::string& what) {
  throw RejectedError(folder.string() + ": the state folder " + what);
}

std::string ErrorText() { return std::strerror(errno); }

std::string TemporaryOf(const std::string& name) { return name + ".part"; }

}  // namespace

StateFolder::StateFolder(const std::filesystem::path& folder)
    : folder_(std::filesystem::absolute(folder)) {
  std::error_code error;
  const bool created = std::filesystem::create_directories(folder_, error);
  if (error) Refuse(folder_, "cannot be created: " + error.message() + kAdvice);
  fd_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd_ < 0) Refuse(folder_, "cannot be opened: " + ErrorText() + kAdvice);
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    const std::string cause = errno == EWOULDBLOCK
                                  ? "belongs to a daemon that runs; stop it first, or give each "
                                    "daemon its own with daemon.state_directory or --state-dir"
                                  : "cannot be locked: " + ErrorText() + kAdvice;
    ::close(fd_);
    Refuse(folder_, cause);
  }
  // Otherwise a power failure could take the new folder away, and the file in it.
  if (created) ::syncfs(fd_);
}

StateFolder::~StateFolder() { ::close(fd_); }

FileText StateFolder::Read(const std::string& name) const {
  // Non-blocking, so that a FIFO in its place does not hang the start.
  const int fd = ::openat(fd_, name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0 && errno != ENOENT) {
    return {.text = {}, .problem = PathOf(name) + ": cannot be opened: " + ErrorText()};
  }
  if (fd < 0) {
    struct stat there{};
    const std::string part = TemporaryOf(name);
    if (::fstatat(fd_, part.c_str(), &there, AT_SYMLINK_NOFOLLOW) != 0 && errno == ENOENT) {
      return {};
    }
    return {.text = {}, .problem = PathOf(part) + ": the writing of this file was interrupted"};
  }
  FileContent content = ReadOpenFile(fd, kStateFile);
  ::close(fd);
  if (content.problem) return {.text = {}, .problem = content.problem->Text(PathOf(name))};
  return {.text = std::move(content.text), .problem = {}};
}

FileChange StateFolder::Replace(const std::string& name, const std::string& text) const {
  FileChange change = ReplaceFile({.folder = fd_, .name = name, .part = TemporaryOf(name)}, text);
  if (!change.problem.empty()) change.problem = PathOf(name) + ": " + change.problem;
  return change;
}

FileChange StateFolder::Remove(const std::string& name) const {
  for (const std::string& file : {TemporaryOf(name), name}) {
    if (::unlinkat(fd_, file.c_str(), 0) == 0 || errno == ENOENT) continue;
    return {.problem = PathOf(file) + ": cannot be removed: " + ErrorText()};
  }
  if (::fsync(fd_) == 0) return {};
  return {.problem = PathOf(name) + ": the folder cannot be synced: " + ErrorText()};
}

}  // namespace flexarm
