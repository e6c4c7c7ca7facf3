#include "controller/operator/operator_client.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "controller/operator/unix_address.h"
#include "controller/types/rejected_error.h"

namespace flexarm {

std::string AskDaemon(const std::string& path, const std::string& line, double timeout_s) {
  const UnixAddress address(path);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const auto fail = [&](const std::string& what) {
    close(fd);
    throw RejectedError(path + ": " + what);
  };
  if (connect(fd, address.get(), address.size()) != 0) {
    if (errno == EACCES) {
      fail(
          "this user may not operate the arm (Permission denied): be a member of the socket's "
          "group, which is flexarm for the service (adduser USER flexarm, and log in again)");
    }
    fail("no daemon answers (" + std::string(std::strerror(errno)) +
         "); start flexarmd, or name its socket with --socket or -c FILE");
  }
  const std::string text = line + "\n";
  if (send(fd, text.data(), text.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(text.size())) {
    fail("the daemon did not take the command (" + std::string(std::strerror(errno)) + ")");
  }
  std::string reply;
  pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
  while (reply.find('\n') == std::string::npos) {
    if (poll(&ready, 1, static_cast<int>(timeout_s * 1e3)) <= 0) fail("the daemon does not answer");
    std::array<char, 4096> chunk;
    const ssize_t count = recv(fd, chunk.data(), chunk.size(), 0);
    if (count <= 0) fail("the daemon closed the connection");
    reply.append(chunk.data(), static_cast<std::size_t>(count));
  }
  close(fd);
  return reply.substr(0, reply.find('\n'));
}

}  // namespace flexarm
