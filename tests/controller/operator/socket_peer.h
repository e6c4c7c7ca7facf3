#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <optional>
#include <string>

#include "controller/operator/unix_address.h"

namespace flexarm {

/// A path of a socket in a folder of this test alone, short enough for an address.
inline std::string SocketPath() {
  std::string folder = "/tmp/flexarm-XXXXXX";
  EXPECT_NE(mkdtemp(folder.data()), nullptr);
  return folder + "/socket";
}

/// A client of the operator socket that never blocks, so that one thread can be both its ends.
class SocketPeer {
 public:
  explicit SocketPeer(const std::string& path)
      : fd_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    const UnixAddress address(path);
    EXPECT_EQ(connect(fd_, address.get(), address.size()), 0) << path;
  }
  ~SocketPeer() { Close(); }
  SocketPeer(const SocketPeer&) = delete;
  SocketPeer& operator=(const SocketPeer&) = delete;

  void Close() {
    if (fd_ >= 0) close(fd_);
    fd_ = -1;
  }

  /// Sends nothing more, and still reads.
  void EndOfSending() const { EXPECT_EQ(shutdown(fd_, SHUT_WR), 0); }

  /// @returns bytes that the socket took
  std::size_t Send(const std::string& text) const {
    const ssize_t sent = send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
    return sent > 0 ? static_cast<std::size_t>(sent) : 0;
  }

  /// The next line that has come, without its newline.
  std::optional<std::string> Line() {
    Read();
    const std::size_t end = received_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    const std::string line = received_.substr(0, end);
    received_.erase(0, end + 1);
    return line;
  }

  /// The other end has closed the connection.
  bool closed() {
    Read();
    return closed_;
  }

 private:
  void Read() {
    std::array<char, 4096> chunk;
    ssize_t count = 0;
    while ((count = recv(fd_, chunk.data(), chunk.size(), 0)) > 0) {
      received_.append(chunk.data(), static_cast<std::size_t>(count));
    }
    closed_ = closed_ || count == 0 || (errno != EAGAIN && errno != EINTR);
  }

  int fd_;
  std::string received_;
  bool closed_ = false;
};

}  // namespace flexarm
