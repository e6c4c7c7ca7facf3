#include "controller/files/external_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/files/nesting.h"
#include "controller/files/utf8.h"

namespace flexarm {
namespace {

FileProblem NotRead(int error, const std::string& expected) {
  return {.line = 0,
          .what = std::string("cannot be read: ") + std::strerror(error) + "; expected " + expected,
          .missing = error == ENOENT};
}

std::optional<FileProblem> NotRegular(const struct stat& there, const std::string& expected) {
  if (S_ISREG(there.st_mode)) return std::nullopt;
  return FileProblem{
      .line = 0,
      .what = std::string("is ") + FileTypeName(there.st_mode) + "; expected " + expected};
}

// A regular file, open for reading. The opening of a device may have an effect, and that of a FIFO
// would wait: so it is asked for before, and non-blocking, since it may be replaced in between.
class OpenFile {
 public:
  OpenFile(const std::filesystem::path& file, const std::string& expected) {
    struct stat there{};
    if (::stat(file.c_str(), &there) != 0) {
      problem_ = NotRead(errno, expected);
      return;
    }
    problem_ = NotRegular(there, expected);
    if (problem_) return;
    fd_ = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (fd_ < 0 || ::fstat(fd_, &there) != 0) {
      problem_ = NotRead(errno, expected);
    } else {
      problem_ = NotRegular(there, expected);
    }
  }
  ~OpenFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  const std::optional<FileProblem>& problem() const { return problem_; }
  int fd() const { return fd_; }

 private:
  int fd_ = -1;
  std::optional<FileProblem> problem_;
};

std::string SizeText(std::size_t bytes) {
  return bytes % kMiB == 0 ? std::to_string(bytes / kMiB) + " MiB"
                           : std::to_string(bytes / 1024) + " KiB";
}

FileProblem TooLarge(const FileKind& kind) {
  return {.line = 0,
          .what = "is larger than " + SizeText(kind.most_bytes) + "; expected " + kind.name};
}

// Reads at most `most_bytes`; the error number of the system, or 0.
int ReadUpTo(int fd, std::size_t most_bytes, std::string* text) {
  constexpr std::size_t kChunk = 65'536;
  while (text->size() < most_bytes) {
    const std::size_t had = text->size();
    text->resize(had + std::min(kChunk, most_bytes - had));
    const ssize_t count = ::read(fd, text->data() + had, text->size() - had);
    const int error = errno;
    text->resize(had + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count < 0 && error == EINTR) continue;
    if (count < 0) return error;
    if (count == 0) return 0;
  }
  return 0;
}

// What stands in no text file. TOML forbids these, and the contents of a CSV file become TOML.
bool IsBinary(char c) {
  const auto value = static_cast<unsigned char>(c);
  return (value < 0x20 && c != '\n' && c != '\r' && c != '\t') || value == 0x7F;
}

std::optional<FileProblem> EncodingProblem(std::string_view text) {
  int line = 1;
  while (!text.empty()) {
    const std::size_t length = Utf8Length(text);
    if (length == 0) {
      return FileProblem{.line = line,
                         .what = "found the byte " + Shown(text.substr(0, 1)) +
                                 ", which is not UTF-8; expected text in UTF-8"};
    }
    if (IsBinary(text.front())) {
      return FileProblem{
          .line = line,
          .what = "found the control character " + Shown(text.substr(0, 1)) + "; expected text"};
    }
    if (text.front() == '\n') ++line;
    text.remove_prefix(length);
  }
  return std::nullopt;
}

}  // namespace

const char* FileTypeName(unsigned mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  if (S_ISSOCK(mode)) return "a socket";
  return "no regular file";
}

std::string FileProblem::Text(const std::filesystem::path& file) const {
  const std::string place = line > 0 ? ":" + std::to_string(line) : std::string();
  return Shown(file.string(), kMessageBytes) + place + ": " + what;
}

std::optional<FileProblem> ProblemOfText(std::string_view text, const FileKind& kind) {
  if (auto problem = EncodingProblem(text)) return problem;
  const int line = kind.syntax == FileSyntax::kToml   ? LineNestedTooDeepToml(text)
                   : kind.syntax == FileSyntax::kJson ? LineNestedTooDeepJson(text)
                                                      : 0;
  if (line == 0) return std::nullopt;
  return FileProblem{.line = line,
                     .what = "is nested more than " + std::to_string(kDeepestNesting) +
                             " levels deep; expected " + kind.name};
}

std::string PlainText(std::string text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (std::string_view(text).substr(0, 3) == kByteOrderMark) text.erase(0, 3);
  if (text.find('\r') == std::string::npos) return text;
  std::size_t to = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') continue;
    text[to++] = text[i] == '\r' ? '\n' : text[i];
  }
  text.resize(to);
  return text;
}

FileContent ReadOpenFile(int fd, const FileKind& kind) {
  struct stat there{};
  if (::fstat(fd, &there) != 0) return {.text = {}, .problem = NotRead(errno, kind.name)};
  if (auto problem = NotRegular(there, kind.name)) return {.text = {}, .problem = problem};
  if (there.st_size > 0 && static_cast<std::size_t>(there.st_size) > kind.most_bytes) {
    return {.text = {}, .problem = TooLarge(kind)};
  }
  std::string text;
  // The size that fstat gives may change, or be 0 as in /proc: what was read counts.
  const int error = ReadUpTo(fd, kind.most_bytes + 1, &text);
  if (error != 0) return {.text = {}, .problem = NotRead(error, kind.name)};
  if (text.size() > kind.most_bytes) return {.text = {}, .problem = TooLarge(kind)};
  text = PlainText(std::move(text));
  if (auto problem = ProblemOfText(text, kind)) return {.text = {}, .problem = problem};
  return {.text = std::move(text), .problem = {}};
}

FileContent ReadExternalFile(const std::filesystem::path& file, const FileKind& kind) {
  const OpenFile open(file, kind.name);
  if (open.problem()) return {.text = {}, .problem = open.problem()};
  return ReadOpenFile(open.fd(), kind);
}

std::string ReadExternalText(const std::filesystem::path& file, const FileKind& kind) {
  FileContent content = ReadExternalFile(file, kind);
  if (content.problem) throw InputError(content.problem->Text(file));
  return std::move(content.text);
}

std::optional<FileProblem> ProblemOfPlace(const std::filesystem::path& file,
                                          const std::string& expected) {
  return OpenFile(file, expected).problem();
}

std::string Beginning(const std::filesystem::path& file, std::size_t most_bytes) {
  const OpenFile open(file, "a regular file");
  std::string text;
  if (open.problem()) return text;
  return ReadUpTo(open.fd(), most_bytes, &text) == 0 ? text : std::string();
}

}  // namespace flexarm
