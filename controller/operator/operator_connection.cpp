#include "controller/operator/operator_connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <utility>

namespace flexarm {

OperatorConnection::OperatorConnection(int fd, int number, Peer peer)
    : fd_(fd), number_(number), peer_(std::move(peer)) {}

OperatorConnection::~OperatorConnection() { Close(); }

OperatorConnection::OperatorConnection(OperatorConnection&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      number_(other.number_),
      peer_(std::move(other.peer_)),
      received_(std::move(other.received_)),
      read_(other.read_),
      line_end_(other.line_end_),
      ended_(other.ended_),
      unanswered_(other.unanswered_),
      quiet_polls_(other.quiet_polls_),
      waited_polls_(other.waited_polls_) {}

OperatorConnection& OperatorConnection::operator=(OperatorConnection&& other) noexcept {
  if (this == &other) return *this;
  Close();
  fd_ = std::exchange(other.fd_, -1);
  number_ = other.number_;
  peer_ = std::move(other.peer_);
  received_ = std::move(other.received_);
  read_ = other.read_;
  line_end_ = other.line_end_;
  ended_ = other.ended_;
  unanswered_ = other.unanswered_;
  quiet_polls_ = other.quiet_polls_;
  waited_polls_ = other.waited_polls_;
  return *this;
}

bool OperatorConnection::over() const {
  if (fd_ < 0) return true;
  return ended_ && !HasLine() && (unanswered_ == 0 || quiet_polls_ > kLingerPolls);
}

bool OperatorConnection::CanBeReached() const {
  if (fd_ < 0) return false;
  pollfd end{.fd = fd_, .events = 0, .revents = 0};
  return poll(&end, 1, 0) == 0;  // both directions closed: POLLHUP
}

std::optional<std::string> OperatorConnection::NextLine() {
  if (!HasLine()) return std::nullopt;
  std::string line = received_.substr(read_, line_end_ - read_);
  read_ = line_end_ + 1;
  line_end_ = received_.find('\n', read_);
  ++unanswered_;
  quiet_polls_ = 0;
  return line;
}

// Not while whole lines wait: their client is ahead of what is done for it.
void OperatorConnection::Read(bool arrived) {
  ++quiet_polls_;
  waited_polls_ = HasLine() ? waited_polls_ + 1 : 0;
  if (!arrived || fd_ < 0 || ended_ || HasLine()) return;
  received_.erase(0, std::exchange(read_, 0));
  const std::size_t searched = received_.size();
  std::array<char, 16384> chunk;
  for (std::size_t taken = 0; taken < kReadPerPoll;) {
    const ssize_t count = recv(fd_, chunk.data(), chunk.size(), 0);
    if (count > 0) {
      received_.append(chunk.data(), static_cast<std::size_t>(count));
      taken += static_cast<std::size_t>(count);
      continue;
    }
    ended_ = count == 0 || (errno != EAGAIN && errno != EINTR);
    break;
  }
  line_end_ = received_.find('\n', searched);
  if (received_.size() < kLongLine && received_.capacity() > kReadPerPoll)
    received_.shrink_to_fit();
  if (received_.size() > kMaxLine && !HasLine()) {
    Dismiss("line-too-long", "a line is longer than " + std::to_string(kMaxLine) + " bytes");
  }
}

void OperatorConnection::Reply(const std::string& line) {
  unanswered_ = std::max(unanswered_ - 1, 0);
  Send(line);
}

void OperatorConnection::Dismiss(const std::string& refusal, const std::string& reason) {
  CloseWith(nlohmann::json{{"ok", false},
                           {"refusal", refusal},
                           {"error", "the daemon closes this connection: " + reason},
                           {"remedy", "connect again"}}
                .dump());
}

void OperatorConnection::CloseWith(const std::string& line) {
  Send(line);
  Close();
}

void OperatorConnection::Send(const std::string& line) {
  if (fd_ < 0) return;
  const std::string text = line + "\n";
  const ssize_t sent = send(fd_, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent != static_cast<ssize_t>(text.size())) Close();
}

void OperatorConnection::Close() {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
}

}  // namespace flexarm
