#include "controller/runlog/append_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <utility>
#include <vector>

#include "controller/runlog/reserved_run_file.h"
#include "controller/runlog/run_file_lock.h"

namespace flexarm {
namespace {

constexpr std::size_t kKeptCapacity = 1 << 20;  // of a buffer that a disk's trouble has filled
constexpr std::size_t kCopyBytes = 1 << 18;

// @returns bytes written; fewer than asked only with an error
std::size_t WriteAt(int fd, std::string_view bytes, std::uint64_t offset, int* error) {
  std::size_t done = 0;
  *error = 0;
  while (done < bytes.size()) {
    const ssize_t count =
        ::pwrite(fd, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      *error = count < 0 ? errno : EIO;
      break;
    }
    done += static_cast<std::size_t>(count);
  }
  return done;
}

// @returns 0, or the error
int CopyBytes(int from, int to, std::uint64_t size) {
  std::vector<char> chunk(kCopyBytes);
  for (std::uint64_t offset = 0; offset < size;) {
    const ssize_t count =
        ::pread(from, chunk.data(), std::min<std::uint64_t>(kCopyBytes, size - offset),
                static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count < 0 ? errno : EIO;
    int error = 0;
    const auto bytes = static_cast<std::size_t>(count);
    if (WriteAt(to, {chunk.data(), bytes}, offset, &error) != bytes) return error;
    offset += bytes;
  }
  return 0;
}

// "run-2.flexarm", "run-3.flexarm", .. until one is free.
int RenameBeside(const std::filesystem::path& from, std::filesystem::path* to) {
  const std::filesystem::path wanted = *to;
  for (int n = 2;; ++n) {
    const int error = RenameToNewName(from, *to);
    if (error != EEXIST) return error;
    *to = wanted.parent_path() /
          (wanted.stem().string() + "-" + std::to_string(n) + wanted.extension().string());
  }
}

}  // namespace

std::filesystem::path PartOf(const std::filesystem::path& file) {
  std::string name(".");
  name.append(file.filename().string()).append(".part");
  return file.parent_path() / name;
}

int SyncDirectory(const std::filesystem::path& directory) {
  const std::filesystem::path& name = directory.empty() ? std::filesystem::path(".") : directory;
  const FileDescriptor fd(::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!fd.is_open()) return errno;
  return ::fsync(fd.get()) == 0 ? 0 : errno;
}

AppendFile::AppendFile(std::filesystem::path path, FileDescriptor fd)
    : path_(std::move(path)), fd_(std::move(fd)) {}

bool AppendFile::Fail(const char* what, int error) {
  trouble_ = path_.string() + ": " + what + ": " + std::strerror(error);
  return false;
}

bool AppendFile::Flush() noexcept {
  try {
    if (!KeepName()) return false;
    int error = 0;
    const std::size_t done = WriteAt(fd_.get(), pending_, written_, &error);
    written_ += done;
    pending_.erase(0, done);
    if (error != 0) return Fail("cannot write the run log", error);
    if (pending_.capacity() > kKeptCapacity) pending_.shrink_to_fit();
    trouble_.clear();
    return true;
  } catch (const std::exception&) {  // no memory for a message: tried again at the next Flush
    return false;
  }
}

bool AppendFile::Sync() noexcept {
  if (!Flush()) return false;
  // A file system keeps the blocks that were reserved behind the end until this call.
  if (::ftruncate(fd_.get(), static_cast<off_t>(written_)) != 0 || ::fdatasync(fd_.get()) != 0) {
    return Fail("cannot write the run log", errno);
  }
  return true;
}

bool AppendFile::KeepName() {
  struct stat named{};
  if (::lstat(path_.c_str(), &named) != 0 && errno != ENOENT && errno != ENOTDIR) return true;
  return NamesFile(path_, fd_.get()) || MakeAgain();
}

// The file was removed, renamed, or another one stands in its place: that one is left alone.
bool AppendFile::MakeAgain() {
  constexpr const char* kWhat = "was removed, and cannot be made again";
  const std::filesystem::path part = PartOf(path_);
  std::error_code ignored;  // opening the file reports what is wrong with the folder
  if (path_.has_parent_path()) std::filesystem::create_directories(path_.parent_path(), ignored);
  ::unlink(part.c_str());  // of an attempt before
  FileDescriptor again(::open(part.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0644));
  if (!again.is_open()) return Fail(kWhat, errno);
  std::filesystem::path name = path_;
  int error = LockRunFile(again.get()) ? CopyBytes(fd_.get(), again.get(), written_) : errno;
  if (error == 0) error = RenameBeside(part, &name);
  if (error != 0) {
    ::unlink(part.c_str());
    return Fail(kWhat, error);
  }
  path_ = name;
  fd_ = std::move(again);
  return true;
}

}  // namespace flexarm
