#include "controller/latch/state_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

constexpr std::size_t kLargestFile = 65'536;  // bytes; no file of ours comes near
constexpr const char* kAdvice =
    "; set daemon.state_directory, or --state-dir, to a folder that this user may write";

[[noreturn]] void Refuse(const std::filesystem::path& folder, const std::string& what) {
  throw RejectedError(folder.string() + ": the state folder " + what);
}

std::string ErrorText() { return std::strerror(errno); }

std::string TemporaryOf(const std::string& name) { return name + ".part"; }

// Empty if all was written and synced.
std::string WriteWhole(int fd, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(fd, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return "cannot be written: " + ErrorText();
    done += static_cast<std::size_t>(count);
  }
  return ::fsync(fd) == 0 ? std::string() : "cannot be synced: " + ErrorText();
}

// Empty if `text` has all of the file.
std::string ReadWhole(int fd, std::string* text) {
  struct stat there{};
  if (::fstat(fd, &there) != 0 || !S_ISREG(there.st_mode)) return "is not a regular file";
  std::array<char, 4096> chunk;
  for (;;) {
    const ssize_t count = ::read(fd, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return "cannot be read: " + ErrorText();
    if (count == 0) return {};
    text->append(chunk.data(), static_cast<std::size_t>(count));
    if (text->size() > kLargestFile) return "is larger than any that the daemon writes";
  }
}

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
  std::string text;
  const std::string problem = ReadWhole(fd, &text);
  ::close(fd);
  if (!problem.empty()) return {.text = {}, .problem = PathOf(name) + ": " + problem};
  return {.text = std::move(text), .problem = {}};
}

FileChange StateFolder::Replace(const std::string& name, const std::string& text) const {
  const std::string part = TemporaryOf(name);
  const auto failed = [&](const std::string& problem) {
    ::unlinkat(fd_, part.c_str(), 0);
    return FileChange{.problem = PathOf(name) + ": " + problem, .untouched = true};
  };
  const int fd =
      ::openat(fd_, part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (fd < 0) return failed("cannot be written: " + ErrorText());
  const std::string problem = WriteWhole(fd, text);
  ::close(fd);
  if (!problem.empty()) return failed(problem);
  if (::renameat(fd_, part.c_str(), fd_, name.c_str()) != 0) {
    return failed("cannot be replaced: " + ErrorText());
  }
  if (::fsync(fd_) == 0) return {};
  return {.problem = PathOf(name) + ": the folder cannot be synced: " + ErrorText()};
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
