#include "tools/plot/gnuplot.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "controller/files/external_text.h"

namespace flexarm {
namespace {

constexpr const char* kPictureMark = "Drawn by flexarm";
constexpr int kNotFound = 127;            // exit code of a child that could not start the program
constexpr std::size_t kShownLabel = 200;  // bytes of a label, which may come from a log
constexpr std::size_t kShownMessages = 300;  // bytes of what gnuplot says

// A nameless file that is gone when it is closed.
class ScratchFile {
 public:
  ScratchFile() : file_(std::tmpfile()) {
    if (file_ == nullptr) {
      throw std::runtime_error(std::string("no temporary file can be made: ") +
                               std::strerror(errno));
    }
  }
  ~ScratchFile() { std::fclose(file_); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  int fd() const { return ::fileno(file_); }
  void Write(const std::string& text) {
    const bool done = std::fwrite(text.data(), 1, text.size(), file_) == text.size();
    if (!done || std::fseek(file_, 0, SEEK_SET) != 0) {  // which flushes
      throw std::runtime_error(std::string("a temporary file cannot be written: ") +
                               std::strerror(errno));
    }
  }
  std::string Text() {
    std::string text;
    std::array<char, 65'536> chunk;
    std::size_t count = std::fseek(file_, 0, SEEK_SET) == 0 ? chunk.size() : 0;
    while (count == chunk.size()) {
      count = std::fread(chunk.data(), 1, chunk.size(), file_);
      text.append(chunk.data(), count);
    }
    return text;
  }

 private:
  std::FILE* file_;
};

// What gnuplot draws for a script. Files and no pipes: neither side can wait for the other.
std::string RunGnuplot(const std::string& script) {
  ScratchFile in, out, messages;
  in.Write(script);
  posix_spawn_file_actions_t redirect;
  posix_spawn_file_actions_init(&redirect);
  posix_spawn_file_actions_adddup2(&redirect, in.fd(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&redirect, out.fd(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&redirect, messages.fd(), STDERR_FILENO);
  std::string program = "gnuplot";
  const std::array<char*, 2> arguments = {program.data(), nullptr};
  pid_t child = 0;
  const int error =
      ::posix_spawnp(&child, "gnuplot", &redirect, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&redirect);
  int status = 0;
  if (error != 0 || ::waitpid(child, &status, 0) != child || WEXITSTATUS(status) == kNotFound) {
    throw std::runtime_error("gnuplot cannot be started; it is in the Debian package gnuplot-nox");
  }
  if (status != 0) {
    throw std::runtime_error("gnuplot failed: " + Shown(messages.Text(), kShownMessages));
  }
  return out.Text();
}

// CRC-32 of ISO 3309, as PNG has it behind every chunk.
std::uint32_t Crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

std::string BigEndian(std::uint32_t value) {
  std::string bytes;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    bytes += static_cast<char>(static_cast<unsigned char>(value >> shift));
  }
  return bytes;
}

// The picture with kPictureMark in it: a text chunk behind the header of a PNG, a comment behind
// the first line of an SVG.
std::string MarkedPicture(std::string picture) {
  constexpr std::size_t kPngHeader = 33;  // signature and chunk IHDR
  if (picture.size() > kPngHeader && picture.compare(1, 3, "PNG") == 0) {
    std::string chunk = "tEXtSoftware";
    chunk += '\0';
    chunk += kPictureMark;
    const auto length = static_cast<std::uint32_t>(chunk.size() - 4);
    return picture.insert(kPngHeader, BigEndian(length) + chunk + BigEndian(Crc32(chunk)));
  }
  const std::size_t line = picture.find('\n');
  if (line == std::string::npos) throw std::runtime_error("gnuplot drew nothing");
  return picture.insert(line + 1, std::string("<!-- ") + kPictureMark + " -->\n");
}

}  // namespace

std::string QuotedPath(const std::string& path) {
  std::string quoted = "'";
  for (const char c : path) quoted += c == '\'' ? "''" : std::string(1, c == '\n' ? ' ' : c);
  return quoted + "'";
}

std::string Quoted(const std::string& text) {
  std::string plain;
  for (const char c : Shown(text, kShownLabel)) {
    if (std::strchr("\\_^{}@&~", c) != nullptr) plain += '\\';
    plain += c;
  }
  return QuotedPath(plain);
}

OutputRules PictureRules(std::vector<std::filesystem::path> inputs, bool overwrite) {
  return {.kind = "a picture",
          .mark = kPictureMark,
          .inputs = std::move(inputs),
          .overwrite = overwrite};
}

OutputRules ReplacedPicture() { return PictureRules({}, true); }

void DrawPicture(const std::string& script, const std::filesystem::path& output,
                 const OutputRules& rules) {
  CheckOutput(output, rules);
  WriteFile(output, MarkedPicture(RunGnuplot(script)), rules);
}

}  // namespace flexarm
