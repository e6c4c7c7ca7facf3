// The calls themselves, in place of the C library's: also SQLite's go through here.

#include "tests/controller/runlog/faulty_calls.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>

namespace flexarm {

CallFault (*before_file_call)(std::string_view call, std::size_t bytes) = nullptr;

namespace {

CallFault Ask(std::string_view call, std::size_t bytes) {
  return before_file_call == nullptr ? CallFault{} : before_file_call(call, bytes);
}

template <typename Function>
Function Real(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

// For calls that return 0 or -1.
template <typename... Arguments>
int Call(const char* name, Arguments... arguments) {
  const CallFault fault = Ask(name, 0);
  if (fault.error == 0) return Real<int (*)(Arguments...)>(name)(arguments...);
  errno = fault.error;
  return -1;
}

ssize_t WriteAt(int fd, const void* bytes, std::size_t count, off_t offset) {
  const auto real = Real<ssize_t (*)(int, const void*, std::size_t, off_t)>("pwrite");
  const CallFault fault = Ask("pwrite", count);
  if (fault.error == 0) return real(fd, bytes, count, offset);
  if (fault.halves_write && count > 1) return real(fd, bytes, count / 2, offset);
  errno = fault.error;
  return -1;
}

int Open(const char* name, const char* path, int flags, mode_t mode) {
  const CallFault fault = (flags & O_CREAT) != 0 ? Ask("open", 0) : CallFault{};
  if (fault.error == 0) return Real<int (*)(const char*, int, ...)>(name)(path, flags, mode);
  errno = fault.error;
  return -1;
}

mode_t ModeOf(int flags, va_list arguments) {
  return (flags & O_CREAT) != 0 ? static_cast<mode_t>(va_arg(arguments, int)) : 0;
}

}  // namespace
}  // namespace flexarm

extern "C" {

ssize_t pwrite(int fd, const void* bytes, size_t count, off_t offset) {
  return flexarm::WriteAt(fd, bytes, count, offset);
}
ssize_t pwrite64(int fd, const void* bytes, size_t count, off64_t offset) {
  return flexarm::WriteAt(fd, bytes, count, offset);
}
ssize_t write(int fd, const void* bytes, size_t count) {
  const flexarm::CallFault fault = flexarm::Ask("write", count);
  if (fault.error == 0) {
    return flexarm::Real<ssize_t (*)(int, const void*, size_t)>("write")(fd, bytes, count);
  }
  errno = fault.error;
  return -1;
}
int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flexarm::ModeOf(flags, arguments);
  va_end(arguments);
  return flexarm::Open("open", path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flexarm::ModeOf(flags, arguments);
  va_end(arguments);
  return flexarm::Open("open64", path, flags, mode);
}
int ftruncate(int fd, off_t length) noexcept { return flexarm::Call("ftruncate", fd, length); }
int ftruncate64(int fd, off64_t length) noexcept {
  return flexarm::Call("ftruncate64", fd, length);
}
int fallocate(int fd, int mode, off_t offset, off_t length) {
  return flexarm::Call("fallocate", fd, mode, offset, length);
}
int fsync(int fd) { return flexarm::Call("fsync", fd); }
int fdatasync(int fd) { return flexarm::Call("fdatasync", fd); }
int rename(const char* from, const char* to) noexcept { return flexarm::Call("rename", from, to); }
int renameat2(int from_fd, const char* from, int to_fd, const char* to,
              unsigned int flags) noexcept {
  return flexarm::Call("renameat2", from_fd, from, to_fd, to, flags);
}
int link(const char* from, const char* to) noexcept { return flexarm::Call("link", from, to); }
int unlink(const char* path) noexcept { return flexarm::Call("unlink", path); }

}  // extern "C"
