#include "tools/torture/line_client.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "controller/operator/unix_address.h"
#include "controller/types/rejected_error.h"

namespace flexarm {

LineClient::LineClient(const std::string& path)
    : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  const UnixAddress address(path);
  if (fd_ >= 0 && connect(fd_, address.get(), address.size()) == 0) return;
  const std::string why = std::strerror(errno);
  if (fd_ >= 0) close(fd_);
  throw RejectedError(path + ": " + why);
}

LineClient::~LineClient() { close(fd_); }

bool LineClient::Send(const std::string& line) const {
  const std::string text = line + "\n";
  return send(fd_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
}

std::optional<std::string> LineClient::Line() {
  std::array<char, 4096> chunk;
  for (ssize_t count = 0; (count = recv(fd_, chunk.data(), chunk.size(), 0)) > 0;) {
    received_.append(chunk.data(), static_cast<std::size_t>(count));
  }
  const std::size_t end = received_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = received_.substr(0, end);
  received_.erase(0, end + 1);
  return line;
}

}  // namespace flexarm
