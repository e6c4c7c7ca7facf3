#include "tools/dashboard/access_token.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <system_error>

#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/runlog/file_descriptor.h"

namespace flexarm {
namespace {

constexpr std::size_t kFreshBytes = 32;

// What may stand in the header Authorization: RFC 6750, b64token, with "_".
bool MayStandInAToken(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-._~+/=").find(c) != std::string_view::npos;
}

[[noreturn]] void Fail(const std::filesystem::path& file, const std::string& what) {
  throw InputError(Shown(file.string(), kMessageBytes) + ": " + what);
}

// The beginning of the file, which is enough to see that a line is too long.
std::string BeginningOf(const std::filesystem::path& file) {
  const FileDescriptor opened(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat there{};
  if (!opened.is_open() || fstat(opened.get(), &there) != 0) {
    Fail(file, std::string("cannot be read: ") + std::strerror(errno));
  }
  if (!S_ISREG(there.st_mode)) Fail(file, "is not a file; a token is one line of a file");
  if ((there.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    Fail(file, "others than its owner can read or write it: chmod 600 it, and change the token");
  }
  std::array<char, AccessToken::kMostBytes + 2> bytes{};
  const ssize_t count = read(opened.get(), bytes.data(), bytes.size());
  if (count < 0) Fail(file, std::string("cannot be read: ") + std::strerror(errno));
  return {bytes.data(), static_cast<std::size_t>(count)};
}

}  // namespace

AccessToken AccessToken::Fresh() {
  std::array<unsigned char, kFreshBytes> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::system_error(errno, std::generic_category(), "getrandom");
  }
  std::string text;
  for (const unsigned char byte : bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    text += {kDigits[byte >> 4U], kDigits[byte & 0xFU]};
  }
  return AccessToken(text);
}

AccessToken AccessToken::OfFile(const std::filesystem::path& file) {
  std::string text = BeginningOf(file);
  text.erase(std::min(text.find('\n'), text.size()));
  if (text.size() < kLeastBytes || text.size() > kMostBytes) {
    Fail(file, "a token has " + std::to_string(kLeastBytes) + " to " + std::to_string(kMostBytes) +
                   " characters on the first line; make one: (umask 077; head -c 24 /dev/urandom | "
                   "base64 > FILE)");
  }
  if (!std::all_of(text.begin(), text.end(), MayStandInAToken)) {
    Fail(file, "a token has letters, digits and -._~+/= only");
  }
  return AccessToken(text);
}

bool AccessToken::Matches(std::string_view given) const noexcept {
  // `volatile` keeps the compiler from ending the loop at the first difference.
  volatile unsigned difference = given.size() == text_.size() ? 0U : 1U;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const auto a = static_cast<unsigned char>(given[i]);
    const auto b = static_cast<unsigned char>(text_[i % text_.size()]);
    difference = difference | (static_cast<unsigned>(a) ^ static_cast<unsigned>(b));
  }
  return difference == 0U;
}

}  // namespace flexarm
