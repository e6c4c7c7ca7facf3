#include "controller/runlog/run_file_lock.h"

#include <fcntl.h>
#include <sys/stat.h>

#include "controller/runlog/file_descriptor.h"

namespace flexarm {
namespace {

struct flock WholeFile(short type) {
  struct flock lock{};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;  // start and length 0: all of it, however it grows
}

}  // namespace

bool LockRunFile(int fd) {
  const struct flock lock = WholeFile(F_WRLCK);
  return ::fcntl(fd, F_OFD_SETLK, &lock) == 0;
}

bool RunFileIsLocked(int fd) {
  struct flock lock = WholeFile(F_RDLCK);
  return ::fcntl(fd, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

bool RunFileIsLocked(const std::filesystem::path& file) {
  const FileDescriptor fd(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  return fd.is_open() && RunFileIsLocked(fd.get());
}

bool NamesFile(const std::filesystem::path& file, int fd) {
  struct stat named{}, open{};
  return ::lstat(file.c_str(), &named) == 0 && ::fstat(fd, &open) == 0 &&
         named.st_dev == open.st_dev && named.st_ino == open.st_ino;
}

}  // namespace flexarm
