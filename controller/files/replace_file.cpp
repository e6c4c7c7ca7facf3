#include "controller/files/replace_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>

namespace flexarm {
namespace {

// Empty if all was written and synced.
std::string WriteAndSync(int fd, std::string_view text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(fd, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return std::string("cannot be written: ") + std::strerror(errno);
    done += static_cast<std::size_t>(count);
  }
  if (::fsync(fd) == 0) return {};
  return std::string("cannot be synced: ") + std::strerror(errno);
}

}  // namespace

FileChange ReplaceFile(const ReplacedFile& file, std::string_view text) {
  const auto failed = [&file](std::string problem) {
    ::unlinkat(file.folder, file.part.c_str(), 0);
    return FileChange{.problem = std::move(problem), .untouched = true};
  };
  const int fd = ::openat(file.folder, file.part.c_str(),
                          O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, file.mode);
  if (fd < 0) return failed(std::string("cannot be written: ") + std::strerror(errno));
  // A file system without permissions refuses this: the file is written all the same.
  if (file.without_umask) static_cast<void>(::fchmod(fd, file.mode));
  const std::string problem = WriteAndSync(fd, text);
  ::close(fd);
  if (!problem.empty()) return failed(problem);
  if (::renameat(file.folder, file.part.c_str(), file.folder, file.name.c_str()) != 0) {
    return failed(std::string("cannot be replaced: ") + std::strerror(errno));
  }
  if (::fsync(file.folder) == 0) return {};
  return {.problem = std::string("the folder cannot be synced: ") + std::strerror(errno)};
}

}  // namespace flexarm
