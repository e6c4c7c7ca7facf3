// The calls themselves, in place of the C library's.

#include "tests/controller/latch/sync_calls.h"

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>

namespace flexarm {

int file_systems_synced = 0;

namespace {

bool folders_fail = false;

bool IsFolder(int fd) {
  struct stat what{};
  return ::fstat(fd, &what) == 0 && S_ISDIR(what.st_mode);
}

}  // namespace

FoldersFailToSync::FoldersFailToSync() { folders_fail = true; }
FoldersFailToSync::~FoldersFailToSync() { folders_fail = false; }

}  // namespace flexarm

extern "C" {

int fsync(int fd) {
  if (flexarm::folders_fail && flexarm::IsFolder(fd)) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, fd));
}

int syncfs(int fd) noexcept {
  ++flexarm::file_systems_synced;
  return static_cast<int>(::syscall(SYS_syncfs, fd));
}

}  // extern "C"
