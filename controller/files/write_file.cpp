#include "controller/files/write_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "controller/files/external_file.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/files/replace_file.h"

namespace flexarm {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMarkWithin = 4'096;
constexpr unsigned kNewFile = 0666, kPermissions = 07777;

[[noreturn]] void RefuseOutput(const fs::path& file, const std::string& what) {
  throw InputError(Shown(file.string(), kMessageBytes) + ": " + what);
}

bool SameFile(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// The file itself, where `file` is a link to it.
fs::path Target(const fs::path& file) {
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(file, error))) return file;
  fs::path target = fs::canonical(file, error);
  if (error) RefuseOutput(file, "is a link that leads nowhere: " + error.message());
  return target;
}

bool WrittenByFlexarm(const fs::path& file, const std::string& mark) {
  return !mark.empty() && Beginning(file, kMarkWithin).find(mark) != std::string::npos;
}

class Folder {
 public:
  explicit Folder(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    fd_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd_ >= 0) return;
    RefuseOutput(file, std::string("cannot be written: ") + std::strerror(errno) + ": " +
                           Shown(folder.string(), kMessageBytes));
  }
  ~Folder() { ::close(fd_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_ = -1;
};

}  // namespace

void CheckOutput(const fs::path& file, const OutputRules& rules) {
  if (!file.has_filename()) RefuseOutput(file, "expected the name of a file to write");
  struct stat there{};
  if (::stat(Target(file).c_str(), &there) != 0) {
    if (errno != ENOENT) {
      RefuseOutput(file, std::string("cannot be written: ") + std::strerror(errno));
    }
    const Folder exists(file);
    return;
  }
  if (!S_ISREG(there.st_mode)) {
    RefuseOutput(file, std::string("is ") + FileTypeName(there.st_mode) +
                           "; expected a new name or a regular file");
  }
  for (const fs::path& input : rules.inputs) {
    struct stat read{};
    if (::stat(input.c_str(), &read) != 0 || !SameFile(there, read)) continue;
    RefuseOutput(file, "is an input of this command; expected another name for what it writes");
  }
  if (rules.overwrite || WrittenByFlexarm(file, rules.mark)) return;
  RefuseOutput(file, std::string("exists and is not ") + rules.kind +
                         " that flexarm wrote; name another file, or add --overwrite");
}

void WriteFile(const fs::path& file, std::string_view text, const OutputRules& rules) {
  CheckOutput(file, rules);
  const fs::path target = Target(file);
  const Folder folder(target);
  const std::string name = target.filename().string();
  struct stat there{};
  const bool exists = ::stat(target.c_str(), &there) == 0;
  const FileChange change =
      ReplaceFile({.folder = folder.fd(),
                   .name = name,
                   .part = "." + name + "." + std::to_string(::getpid()) + ".part",
                   .mode = exists ? there.st_mode & kPermissions : kNewFile,
                   .without_umask = exists},
                  text);
  if (!change.problem.empty()) RefuseOutput(file, change.problem);
}

OutputRules ReplaceAny(const char* kind) {
  return {.kind = kind, .mark = {}, .inputs = {}, .overwrite = true};
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return;
  RefuseOutput(folder, "cannot be made a folder: " + error.message());
}

void MakeOutputFolder(const fs::path& folder, bool overwrite) {
  MakeFolder(folder);
  std::error_code error;
  const bool empty = fs::is_empty(folder, error);
  if (error) RefuseOutput(folder, "cannot be read: " + error.message());
  if (empty || overwrite) return;
  RefuseOutput(folder, "is a folder with files; name a new or an empty one, or add --overwrite");
}

}  // namespace flexarm
