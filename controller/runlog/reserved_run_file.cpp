#include "controller/runlog/reserved_run_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "controller/runlog/run_file_lock.h"

namespace flexarm {
namespace {

constexpr mode_t kRunFileMode = 0644;

[[noreturn]] void CannotReserve(const std::filesystem::path& where, int error) {
  throw RunLogError(where.string() + ": cannot write the run log: " + std::strerror(error));
}

[[noreturn]] void NameTaken(const std::filesystem::path& file) {
  throw RunLogError(file.string() + ": already exists; a run is never overwritten");
}

void MakeFolder(const std::filesystem::path& folder) {
  std::error_code ignored;  // opening the file reports what is wrong with the folder
  if (!folder.empty()) std::filesystem::create_directories(folder, ignored);
}

// @returns 0, or the error. A file system that cannot reserve is none.
int ReserveSpace(int fd, std::uint64_t bytes) {
  if (bytes == 0) return 0;
  if (::fallocate(fd, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0) return 0;
  return errno == EOPNOTSUPP || errno == ENOSYS ? 0 : errno;
}

}  // namespace

ReservedRunFile::ReservedRunFile(std::filesystem::path path, FileDescriptor fd)
    : path_(std::move(path)), fd_(std::move(fd)) {}

ReservedRunFile::~ReservedRunFile() { Remove(); }

ReservedRunFile::ReservedRunFile(ReservedRunFile&& other) noexcept
    : path_(std::move(other.path_)), fd_(std::move(other.fd_)) {}

ReservedRunFile& ReservedRunFile::operator=(ReservedRunFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(fd_, other.fd_);
  return *this;
}

// Not a file that was put in its place meanwhile.
void ReservedRunFile::Remove() {
  if (fd_.is_open() && NamesFile(path_, fd_.get())) ::unlink(path_.c_str());
}

ReservedRunFile ReservedRunFile::In(const std::filesystem::path& directory, std::uint64_t bytes) {
  MakeFolder(directory);
  std::string name = (directory / ".next-XXXXXX").string();
  name += kReservedSuffix;
  FileDescriptor fd(::mkostemps(name.data(), static_cast<int>(kReservedSuffix.size()), O_CLOEXEC));
  if (!fd.is_open()) CannotReserve(directory, errno);
  ReservedRunFile file(name, std::move(fd));
  ::fchmod(file.fd_.get(), kRunFileMode);  // mkostemps allows the owner only
  if (!LockRunFile(file.fd_.get())) CannotReserve(directory, errno);
  if (const int error = ReserveSpace(file.fd_.get(), bytes)) CannotReserve(directory, error);
  return file;
}

ReservedRunFile ReservedRunFile::At(const std::filesystem::path& name) {
  MakeFolder(name.parent_path());
  FileDescriptor fd(::open(name.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, kRunFileMode));
  if (!fd.is_open() && errno == EEXIST) NameTaken(name);
  if (!fd.is_open()) CannotReserve(name, errno);
  ReservedRunFile file(name, std::move(fd));
  if (!LockRunFile(file.fd_.get())) CannotReserve(name, errno);
  return file;
}

void ReservedRunFile::Rename(const std::filesystem::path& file) {
  const int error = RenameToNewName(path_, file);
  if (error == EEXIST) NameTaken(file);
  if (error != 0) CannotReserve(file, error);
  path_ = file;
}

FileDescriptor ReservedRunFile::Take() { return std::move(fd_); }

std::optional<std::uint64_t> FreeBytes(const std::filesystem::path& directory) {
  struct statvfs there{};
  if (::statvfs(directory.c_str(), &there) != 0) return std::nullopt;
  return std::uint64_t{there.f_bavail} * there.f_frsize;
}

int RenameToNewName(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // The file system does not know that kind of rename.
  if (::link(from.c_str(), to.c_str()) != 0) return errno;
  return ::unlink(from.c_str()) == 0 ? 0 : errno;
}

}  // namespace flexarm
