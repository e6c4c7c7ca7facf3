#include "controller/operator/operator_socket.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "controller/operator/unix_address.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

bool DaemonListens(const UnixAddress& address) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const bool listens = connect(fd, address.get(), address.size()) == 0 || errno == EAGAIN;
  close(fd);
  return listens;
}

}  // namespace

OperatorSocket::OperatorSocket(std::string path) : path_(std::move(path)) {
  const UnixAddress address(path_);
  if (DaemonListens(address)) {
    throw RejectedError(path_ +
                        ": a daemon is listening there already; stop it first, or set "
                        "daemon.socket to another path");
  }
  struct stat there{};
  if (lstat(path_.c_str(), &there) == 0 && S_ISSOCK(there.st_mode)) unlink(path_.c_str());
  listener_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const mode_t old_mask = umask(0117);  // rw-rw----
  const bool bound = listener_ >= 0 && bind(listener_, address.get(), address.size()) == 0 &&
                     listen(listener_, static_cast<int>(kMaxClients)) == 0;
  const std::string cause = std::strerror(errno);
  umask(old_mask);
  if (bound) return;
  if (listener_ >= 0) close(listener_);
  throw RejectedError(path_ + ": cannot listen (" + cause +
                      "); set daemon.socket to a path in a folder that exists and is writable");
}

OperatorSocket::~OperatorSocket() {
  for (const Client& client : clients_) close(client.fd);
  close(listener_);
  unlink(path_.c_str());
}

void OperatorSocket::Accept() {
  for (;;) {
    const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) return;
    if (clients_.size() < kMaxClients) {
      clients_.push_back({.fd = fd, .received = {}});
    } else {
      close(fd);
    }
  }
}

std::vector<OperatorSocket::Message> OperatorSocket::Poll() {
  Accept();
  std::vector<Message> messages;
  std::vector<int> gone;
  for (Client& client : clients_) {
    if (!Read(&client, &messages)) gone.push_back(client.fd);
  }
  for (const int fd : gone) {
    // No answer could reach a client that has closed its connection: its lines are dropped.
    std::erase_if(messages, [fd](const Message& m) { return m.client == fd; });
    Close(fd);
  }
  return messages;
}

bool OperatorSocket::Read(Client* client, std::vector<Message>* messages) {
  std::array<char, 4096> chunk;
  bool open = true;
  for (;;) {
    const ssize_t count = recv(client->fd, chunk.data(), chunk.size(), 0);
    if (count > 0) {
      client->received.append(chunk.data(), static_cast<std::size_t>(count));
      if (client->received.size() > kMaxLine) return false;
      continue;
    }
    open = count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
    break;
  }
  for (std::size_t end; (end = client->received.find('\n')) != std::string::npos;) {
    messages->push_back({.client = client->fd, .line = client->received.substr(0, end)});
    client->received.erase(0, end + 1);
  }
  return open;
}

void OperatorSocket::Reply(int client, const std::string& line) {
  const auto found = std::find_if(clients_.begin(), clients_.end(),
                                  [client](const Client& c) { return c.fd == client; });
  if (found == clients_.end()) return;
  const std::string text = line + "\n";
  const ssize_t sent = send(client, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent != static_cast<ssize_t>(text.size())) Close(client);
}

void OperatorSocket::Close(int fd) {
  close(fd);
  std::erase_if(clients_, [fd](const Client& c) { return c.fd == fd; });
}

}  // namespace flexarm
