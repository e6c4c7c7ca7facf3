#include "hal/emulation/modbus_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "hal/bus_device.h"

namespace flexarm {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMostClients = 8;
constexpr milliseconds kBetweenBytes{20};
constexpr milliseconds kBetweenFloods{1};
constexpr std::size_t kFloodBytes = 16'384;

}  // namespace

ModbusServer::ModbusServer(ModbusDeviceConfig config, const RegisterImage& image)
    : config_(std::move(config)), image_(image), port_(config_.port) {
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  Open();
}

ModbusServer::~ModbusServer() {
  CloseAll();
  if (wake_ >= 0) close(wake_);
}

void ModbusServer::Open() {
  if (rtu()) {
    OpenPseudoTerminal();
  } else {
    Listen();
  }
}

void ModbusServer::Listen() {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port_));
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof(address);
  const int one = 1, small = 1;  // the kernel uses its smallest buffer
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &one, sizeof(one));
  setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &small, sizeof(small));
  if (inet_pton(AF_INET, config_.host.c_str(), &address.sin_addr) != 1 ||
      bind(listener_, generic, size) != 0 ||
      listen(listener_, static_cast<int>(kMostClients)) != 0 ||
      getsockname(listener_, generic, &size) != 0) {
    throw HalError("modbus server '" + config_.name + "': cannot listen on " + config_.host + ":" +
                   std::to_string(port_) + ": " + std::strerror(errno));
  }
  if (port_ == 0) port_ = ntohs(address.sin_port);  // kAway returns to the same port
}

void ModbusServer::OpenPseudoTerminal() {
  const auto fail = [this](const std::string& what) {
    throw HalError("modbus server '" + config_.name + "': " + what + ": " + std::strerror(errno));
  };
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 64> name{};
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
      ptsname_r(master, name.data(), name.size()) != 0) {
    fail("cannot create a pseudo-terminal");
  }
  clients_.push_back({.fd = master, .received = {}});
  path_ = name.data();
  slave_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (slave_ < 0 || tcgetattr(slave_, &settings) != 0) fail(path_);
  cfmakeraw(&settings);  // otherwise replies would be echoed
  tcsetattr(slave_, TCSANOW, &settings);
  if (config_.device.empty()) return;
  struct stat there{};
  if (lstat(config_.device.c_str(), &there) == 0 && S_ISLNK(there.st_mode)) {
    unlink(config_.device.c_str());  // left by a server that died
  }
  if (symlink(path_.c_str(), config_.device.c_str()) != 0) fail(config_.device);
}

void ModbusServer::CloseClient(int fd) noexcept {
  close(fd);
  std::erase_if(clients_, [fd](const Client& client) { return client.fd == fd; });
  std::erase_if(held_, [fd](const Held& held) { return held.fd == fd; });
}

void ModbusServer::CloseAll() noexcept {
  if (rtu() && !clients_.empty() && !config_.device.empty()) unlink(config_.device.c_str());
  while (!clients_.empty()) CloseClient(clients_.front().fd);
  for (int* fd : {&listener_, &slave_}) {
    if (*fd >= 0) close(*fd);
    *fd = -1;
  }
}

void ModbusServer::Give(const Order& order) {
  {
    const std::lock_guard lock(mutex_);
    order_ = order;
    ++asked_;
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(wake_, &one, sizeof(one));
}

void ModbusServer::Stop() noexcept {
  stop_ = true;
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(wake_, &one, sizeof(one));
}

void ModbusServer::Behave(WireFault fault, milliseconds late) {
  Give({.fault = fault, .late = late, .release = false});
}

void ModbusServer::ReleaseLate() {
  Order order;
  {
    const std::lock_guard lock(mutex_);
    order = order_;
  }
  order.release = true;
  Give(order);
}

void ModbusServer::Run() {
  while (!stop_) {
    TakeOrder();
    SendDue();
    if (now_.fault == WireFault::kFlood) Flood();
    Wait();
  }
}

void ModbusServer::TakeOrder() {
  if (settled()) return;
  std::uint64_t asked = 0;
  const WireFault before = now_.fault;
  {
    const std::lock_guard lock(mutex_);
    now_ = order_;
    asked = asked_;
  }
  if (now_.release) {
    Release();
  } else {
    held_.clear();
  }
  const bool away = now_.fault == WireFault::kAway;
  if (away && before != WireFault::kAway) CloseAll();
  if (!away && before == WireFault::kAway) Open();
  taken_ = asked;
}

void ModbusServer::Release() {
  for (Held& held : held_) held.at = Clock::now();
  int bytes = 0;
  for (const Held& held : held_) bytes += static_cast<int>(held.bytes.size());
  SendDue();
  // A pseudo-terminal delivers bytes with a delay.
  for (int there = 0; rtu() && there < bytes && !stop_;) ioctl(slave_, FIONREAD, &there);
}

// In order of due time: the delay is the same for all replies, or they are sequential.
void ModbusServer::SendDue() {
  while (!held_.empty() && held_.front().at <= Clock::now()) {
    const Held due = std::move(held_.front());
    held_.pop_front();
    Send(due.fd, due.bytes);
  }
}

void ModbusServer::Flood() {
  const ModbusBytes rubbish(kFloodBytes, 0xFF);
  for (const Client& client : clients_) {
    const ssize_t sent = rtu() ? write(client.fd, rubbish.data(), rubbish.size())
                               : send(client.fd, rubbish.data(), rubbish.size(), MSG_NOSIGNAL);
    if (sent > 0) flooded_ += sent;  // else its buffers are full
  }
}

int ModbusServer::Timeout() const {
  if (now_.fault == WireFault::kFlood) return static_cast<int>(kBetweenFloods.count());
  if (held_.empty()) return -1;
  const auto left = std::chrono::ceil<milliseconds>(held_.front().at - Clock::now());
  return static_cast<int>(std::max(left, milliseconds(0)).count());
}

void ModbusServer::Wait() {
  const bool reads = now_.fault != WireFault::kNeverReads;
  std::vector<pollfd> ready = {{.fd = wake_, .events = POLLIN, .revents = 0},
                               {.fd = listener_, .events = POLLIN, .revents = 0}};
  for (const Client& client : clients_) {
    ready.push_back({.fd = reads ? client.fd : -1, .events = POLLIN, .revents = 0});
  }
  if (poll(ready.data(), ready.size(), Timeout()) <= 0) return;
  std::uint64_t count = 0;
  if (ready[0].revents != 0) {
    [[maybe_unused]] const ssize_t taken = read(wake_, &count, sizeof(count));
  }
  if (ready[1].revents != 0) Accept();
  for (std::size_t i = 2; i < ready.size(); ++i) {
    if (ready[i].revents != 0) Read(ready[i].fd);
  }
}

void ModbusServer::Accept() {
  const int fd = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  const int one = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof(one));
  if (clients_.size() < kMostClients) {
    clients_.push_back({.fd = fd, .received = {}});
  } else {
    close(fd);
  }
}

void ModbusServer::Read(int fd) {
  ModbusBytes chunk(256);
  const ssize_t count = read(fd, chunk.data(), chunk.size());
  if (count <= 0 && !rtu()) CloseClient(fd);
  if (count <= 0) return;
  const auto find = [this, fd] {
    return std::find_if(clients_.begin(), clients_.end(),
                        [fd](const Client& client) { return client.fd == fd; });
  };
  find()->received.insert(find()->received.end(), chunk.begin(), chunk.begin() + count);
  // A reply may close the client.
  for (auto client = find(); client != clients_.end(); client = find()) {
    const int length = RequestLength(config_.transport, client->received);
    if (length < 0) client->received.clear();
    if (length < 0 && !rtu()) CloseClient(fd);
    if (length <= 0) return;
    const ModbusBytes request(client->received.begin(), client->received.begin() + length);
    client->received.erase(client->received.begin(), client->received.begin() + length);
    Serve(fd, request);
  }
}

void ModbusServer::Serve(int fd, const ModbusBytes& request) {
  using enum WireFault;
  const WireFault fault = now_.fault;
  ++requests_;
  const ModbusBytes right = ReplyFrame(config_, image_, request, kNone);
  const ModbusBytes before = std::exchange(previous_, right);
  if (right.empty() || fault == kSilent || fault == kFlood) return;
  const Clock::time_point now = Clock::now();
  if (fault == kLate) {
    Hold(fd, now + now_.late, right);
  } else if (fault == kOneBehind) {
    Send(fd, before);
  } else if (fault == kByteByByte) {
    const Clock::time_point first = held_.empty() ? now : held_.back().at + kBetweenBytes;
    for (std::size_t i = 0; i < right.size(); ++i) {
      Hold(fd, first + static_cast<int>(i) * kBetweenBytes, {right[i]});
    }
  } else if (fault == kReset || fault == kClose) {
    const linger at_once{.l_onoff = fault == kReset ? 1 : 0, .l_linger = 0};
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
    CloseClient(fd);
  } else {
    ModbusBytes reply = ReplyFrame(config_, image_, request, fault);
    if (fault == kTwice) reply.insert(reply.end(), right.begin(), right.end());
    Send(fd, reply);
    if (fault == kHalfFrameThenClose && !rtu()) CloseClient(fd);
  }
}

void ModbusServer::Hold(int fd, Clock::time_point at, ModbusBytes bytes) {
  held_.push_back({.at = at, .fd = fd, .bytes = std::move(bytes)});
}

void ModbusServer::Send(int fd, const ModbusBytes& bytes) {
  if (bytes.empty()) return;
  const ssize_t sent = rtu() ? write(fd, bytes.data(), bytes.size())
                             : send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  // Read detects that a client is gone; bytes that do not fit are lost, as on a wire.
  static_cast<void>(sent);
}

}  // namespace flexarm
