#include "tests/hal/modbus/hostile_peer.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>

namespace flexarm {
namespace {

using enum Misbehaviour;
using std::chrono::milliseconds;

constexpr std::size_t kTcpRequest = 12;  // header of 7, function, address, count
constexpr std::size_t kRtuRequest = 8;   // unit, function, address, count, checksum

// Modbus over serial line V1.02, 6.2.2.
std::uint16_t Checksum(const std::vector<std::uint8_t>& bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int i = 0; i < 8; ++i) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0xA001U : crc >> 1U;
  }
  return static_cast<std::uint16_t>(crc);
}

void Append(std::vector<std::uint8_t>* bytes, unsigned word) {
  bytes->push_back(static_cast<std::uint8_t>(word >> 8U));
  bytes->push_back(static_cast<std::uint8_t>(word & 0xFFU));
}

std::string LinkPath() {
  return testing::TempDir() + "/flexarm-hostile-" + std::to_string(getpid());
}

}  // namespace

HostilePeer::HostilePeer(ModbusTransport transport) : transport_(transport) {
  if (rtu()) path_ = LinkPath();
  Open();
  thread_ = std::jthread([this] { Serve(); });
}

HostilePeer::~HostilePeer() {
  stop_ = true;
  thread_.join();
  CloseAll();
  if (rtu()) unlink(path_.c_str());
}

void HostilePeer::Open() {
  if (rtu()) {
    client_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
    grantpt(client_);
    unlockpt(client_);
    const std::string name = ptsname(client_);
    held_open_ = open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios settings{};
    tcgetattr(held_open_, &settings);
    cfmakeraw(&settings);
    tcsetattr(held_open_, TCSANOW, &settings);
    unlink(path_.c_str());
    if (symlink(name.c_str(), path_.c_str()) != 0) std::abort();
    return;
  }
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int one = 1, small = 1;  // the kernel makes the smallest buffer of it
  setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &one, sizeof(one));
  setsockopt(listener_, SOL_SOCKET, SO_RCVBUF, &small, sizeof(small));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port_));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  if (bind(listener_, generic, size) != 0 || listen(listener_, 4) != 0) std::abort();
  getsockname(listener_, generic, &size);
  port_ = ntohs(address.sin_port);
}

void HostilePeer::CloseClient() {
  if (client_ >= 0) close(client_);
  client_ = -1;
  received_.clear();
}

void HostilePeer::CloseAll() {
  CloseClient();
  for (int* fd : {&listener_, &held_open_}) {
    if (*fd >= 0) close(*fd);
    *fd = -1;
  }
}

void HostilePeer::ReleaseHeld() {
  release_ = true;
  while (release_) std::this_thread::sleep_for(milliseconds(1));
}

void HostilePeer::Leave() {
  leave_ = true;
  while (leave_) std::this_thread::sleep_for(milliseconds(1));
}

void HostilePeer::Return() {
  return_ = true;
  while (return_) std::this_thread::sleep_for(milliseconds(1));
}

void HostilePeer::Serve() {
  while (!stop_) {
    if (leave_) {
      CloseAll();
      away_ = true;
      leave_ = false;
    }
    if (return_) {
      Open();
      away_ = false;
      return_ = false;
    }
    if (release_) {
      SendAll(held_);
      // A pseudo-terminal hands bytes on when the kernel finds time for it.
      for (int there = 0; rtu() && there < static_cast<int>(held_.size()) && !stop_;) {
        ioctl(held_open_, FIONREAD, &there);
      }
      held_.clear();
      release_ = false;
    }
    if (away_) {
      std::this_thread::sleep_for(milliseconds(1));
      continue;
    }
    const Misbehaviour how = how_;
    bool flooding = false;
    if (how == kFlood && client_ >= 0) {
      const Bytes rubbish(4096, 0xFF);
      const ssize_t sent = rtu() ? write(client_, rubbish.data(), rubbish.size())
                                 : send(client_, rubbish.data(), rubbish.size(), MSG_NOSIGNAL);
      flooding = sent > 0;  // or its buffers are full: wait for room
      if (flooding) flooded_ += sent;
    }
    const bool reads = client_ >= 0 && how != kNeverReads;
    pollfd ready[2] = {{.fd = listener_, .events = POLLIN, .revents = 0},
                       {.fd = reads ? client_ : -1, .events = POLLIN, .revents = 0}};
    if (poll(ready, 2, flooding ? 0 : 1) <= 0) continue;
    if (ready[0].revents != 0) {
      CloseClient();  // a new connection replaces the old one
      client_ = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
      const int one = 1;
      setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &one, sizeof(one));
      continue;
    }
    Bytes chunk(256);
    const ssize_t count = read(client_, chunk.data(), chunk.size());
    if (count <= 0 && !rtu()) CloseClient();
    if (count <= 0) continue;
    received_.insert(received_.end(), chunk.begin(), chunk.begin() + count);
    const auto length = static_cast<std::ptrdiff_t>(rtu() ? kRtuRequest : kTcpRequest);
    while (std::ssize(received_) >= length) {
      const Bytes request(received_.begin(), received_.begin() + length);
      received_.erase(received_.begin(), received_.begin() + length);
      Handle(request);
    }
  }
}

void HostilePeer::Handle(const Bytes& request) {
  ++requests_;
  Answer(how_, request);
  previous_ = Frame(request, kNone);
}

void HostilePeer::Answer(Misbehaviour how, const Bytes& request) {
  const Bytes right = Frame(request, kNone);
  if (how == kSilent || how == kFlood || how == kNeverReads) return;
  if (how == kHeld) {
    held_ = right;
  } else if (how == kOneBehind) {
    SendAll(previous_);
  } else if (how == kByteByByte) {
    Dribble(right);
  } else if (how == kTwice) {
    Bytes twice = right;
    twice.insert(twice.end(), right.begin(), right.end());
    SendAll(twice);
  } else {
    Misanswer(how, request);
  }
}

void HostilePeer::Misanswer(Misbehaviour how, const Bytes& request) {
  Bytes frame = Frame(request, how);
  const auto half = std::ssize(frame) / 2;
  if (how == kGarbage) frame.assign(64, 0xFF);
  if (how == kThreeBytes) frame.resize(3);
  if (how == kHalfFrame || how == kHalfFrameThenClose) {
    frame.resize(static_cast<std::size_t>(half));
  }
  if (how == kReset) {
    const linger at_once{.l_onoff = 1, .l_linger = 0};
    setsockopt(client_, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
  }
  if (how != kReset && how != kClose) SendAll(frame);
  if (how == kReset || how == kClose || how == kHalfFrameThenClose) CloseClient();
}

// What the device's registers hold, as bytes.
HostilePeer::Bytes HostilePeer::Payload(const Bytes& body) const {
  const unsigned address = body[1] * 256U + body[2], count = body[3] * 256U + body[4];
  Bytes payload;
  if (body[0] <= 2) {
    payload.assign((count + 7) / 8, 0xFF);
    return payload;
  }
  for (unsigned i = address; i < address + count; ++i) {
    const unsigned identity = i == 100 ? 0x4142 : 7;
    Append(&payload, body[0] == 3 ? identity : reading_.load());
  }
  return payload;
}

HostilePeer::Bytes HostilePeer::Frame(const Bytes& request, Misbehaviour how) const {
  const std::ptrdiff_t header = rtu() ? 1 : 7;
  const Bytes body(request.begin() + header, request.end());
  Bytes payload = Payload(body);
  if (how == kLongPayload) payload.insert(payload.end(), 2, 0);
  if (how == kShortPayload) payload.clear();
  Bytes pdu = {body[0], static_cast<std::uint8_t>(payload.size())};
  pdu.insert(pdu.end(), payload.begin(), payload.end());
  if (how == kHugePayload) {
    pdu[1] = 255;
    pdu.resize(257);
  }
  if (how == kWrongFunction) pdu[0] ^= 0x01U;  // the neighbouring table
  if (how == kException) pdu = {static_cast<std::uint8_t>(body[0] | 0x80U), 4};
  std::uint8_t unit = request[static_cast<std::size_t>(header - 1)];
  if (how == kWrongUnit) ++unit;
  Bytes frame;
  if (!rtu()) {
    frame = {request[0], request[1], 0, 0};
    if (how == kWrongTransaction) frame[1] ^= 0x01U;
    if (how == kWrongProtocol) frame[3] = 1;
    Append(&frame, static_cast<unsigned>(pdu.size()) + (how == kWrongFrameLength ? 3 : 1));
  }
  frame.push_back(unit);
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  if (rtu()) {
    const unsigned crc = Checksum(frame) ^ (how == kBadChecksum ? 1U : 0U);
    Append(&frame, (crc & 0xFFU) << 8U | crc >> 8U);  // low byte first
  }
  return frame;
}

void HostilePeer::SendAll(const Bytes& bytes) {
  if (client_ < 0 || bytes.empty()) return;
  const ssize_t sent = rtu() ? write(client_, bytes.data(), bytes.size())
                             : send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0 && !rtu()) CloseClient();
}

void HostilePeer::Dribble(const Bytes& bytes) {
  for (const std::uint8_t byte : bytes) {
    SendAll({byte});
    std::this_thread::sleep_for(milliseconds(20));
    if (how_ != kByteByByte || stop_) return;
  }
}

}  // namespace flexarm
