#include "controller/operator/operator_client.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "controller/operator/unix_address.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

constexpr std::size_t kMaxAnswer = 4 << 20;  // bytes

// Empty, or the system's error. A signal interrupts nothing.
std::string SendAll(int fd, const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = send(fd, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::strerror(errno);
    sent += static_cast<std::size_t>(count);
  }
  return {};
}

// Whether there is something to read within the time, whatever signals come.
bool Readable(int fd, double within_s) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end =
      Clock::now() + std::chrono::milliseconds(std::llround(within_s * 1e3));
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd ready{.fd = fd, .events = POLLIN, .revents = 0};
    const int count = poll(&ready, 1, static_cast<int>(std::max<std::int64_t>(left, 0)));
    if (count > 0) return true;
    if (count == 0 || errno != EINTR) return false;
  }
}

// A daemon that stands still accepts no connection: when those that wait are too many, a further
// one would wait for ever.
void LimitConnect(int fd, double timeout_s) {
  const std::int64_t us = std::llround(timeout_s * 1e6);
  const timeval limit{.tv_sec = us / 1'000'000, .tv_usec = us % 1'000'000};
  setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
}

}  // namespace

DaemonConnection::DaemonConnection(std::string path, double timeout_s)
    : path_(std::move(path)), socket_(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const UnixAddress address(path_);
  LimitConnect(socket_.get(), timeout_s);
  if (connect(socket_.get(), address.get(), address.size()) == 0) return;
  if (errno == EACCES) {
    Fail(
        "this user may not operate the arm (Permission denied): be a member of the group flexarm "
        "(adduser USER flexarm, and log in again)");
  }
  if (errno == EAGAIN) Fail("the daemon does not answer");
  Fail("no daemon answers (" + std::string(std::strerror(errno)) +
       "); start flexarmd, or name its socket with --socket or -c FILE");
}

void DaemonConnection::Fail(const std::string& what) const {
  throw RejectedError(path_ + ": " + what);
}

void DaemonConnection::Interrupt() noexcept { shutdown(socket_.get(), SHUT_RDWR); }

void DaemonConnection::Receive(double timeout_s, const std::string& problem) {
  if (!Readable(socket_.get(), timeout_s)) Fail("the daemon does not answer");
  std::array<char, 4096> chunk;
  const ssize_t count = recv(socket_.get(), chunk.data(), chunk.size(), 0);
  if (count < 0 && errno == EINTR) return;
  if (count <= 0 && !problem.empty()) Fail("the daemon did not take the command: " + problem);
  if (count <= 0) Fail("the daemon closed the connection");
  received_.append(chunk.data(), static_cast<std::size_t>(count));
  if (received_.size() > kMaxAnswer) Fail("the answer is too long to be one of a daemon");
}

std::string DaemonConnection::Ask(const std::string& line, double timeout_s) {
  // Even if the daemon has closed it: then it has said why.
  const std::string problem = SendAll(socket_.get(), line + "\n");
  std::size_t end = received_.find('\n');
  while (end == std::string::npos) {
    Receive(timeout_s, problem);
    end = received_.find('\n');
  }
  std::string answer = received_.substr(0, end);
  received_.erase(0, end + 1);
  return answer;
}

std::string AskDaemon(const std::string& path, const std::string& line, double timeout_s) {
  return DaemonConnection(path, timeout_s).Ask(line, timeout_s);
}

}  // namespace flexarm
