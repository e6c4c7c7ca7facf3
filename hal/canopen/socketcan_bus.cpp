#include "hal/canopen/socketcan_bus.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <utility>

#include "hal/bus_device.h"
#include "hal/canopen/can_link.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
// Buffer for frames that are not read yet: seconds of traffic of a full set of nodes.
constexpr int kReceiveBytes = 1 << 20;
// The controller's own state only: reports of damaged frames could flood the socket on a bad bus.
constexpr can_err_mask_t kErrorsWanted =
    CAN_ERR_BUSOFF | CAN_ERR_CRTL | CAN_ERR_RESTARTED | CAN_ERR_TX_TIMEOUT;

// The first CAN_MTU bytes are a classic frame; can_frame itself has its length in a union.
using ClassicFrame = canfd_frame;

// Control data of recvmsg: three time stamps, of which the first is the kernel's.
constexpr std::size_t kControlBytes = CMSG_SPACE(3 * sizeof(timespec));

[[noreturn]] void Fail(const std::string& interface, const std::string& what) {
  throw HalError(interface + ": " + what + ": " + std::strerror(errno));
}

template <typename Value>
void Set(const std::string& interface, int fd, int level, int option, const Value& value,
         const char* what) {
  if (setsockopt(fd, level, option, &value, sizeof(value)) != 0) Fail(interface, what);
}

// The kernel's time stamp in CLOCK_REALTIME; 0 if there is none.
std::int64_t StampOf(msghdr* message) noexcept {
  for (cmsghdr* c = CMSG_FIRSTHDR(message); c != nullptr; c = CMSG_NXTHDR(message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPING) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(c), sizeof(stamp));
    return stamp.tv_sec * kSecond_ns + stamp.tv_nsec;
  }
  return 0;
}

struct LinkProblem {
  const char* what;
  std::uint32_t found;
  const char* relation;
  std::uint32_t expected;
  const char* why;
};

// Reason why an interface is unsuitable for drives.
std::optional<LinkProblem> FindProblem(const CanLink& link, std::uint32_t bitrate_bps) noexcept {
  if (!link.up) return LinkProblem{"up", 0, "", 1, ", the interface is down"};
  if (link.transmit_queue > SocketCanBus::kMostQueued) {
    return LinkProblem{"txqueuelen", link.transmit_queue, "at most ", SocketCanBus::kMostQueued,
                       ", commands must not wait in a queue"};
  }
  if (link.controller && link.bitrate_bps != bitrate_bps) {
    return LinkProblem{"bitrate", link.bitrate_bps, "", bitrate_bps, ""};
  }
  if (link.restart_ms != 0) {
    return LinkProblem{"restart-ms", link.restart_ms, "", 0,
                       ", only the operator's reset may restart the bus"};
  }
  return std::nullopt;
}

}  // namespace

SocketCanBus::SocketCanBus(std::string interface, BusClocks clocks)
    : interface_(std::move(interface)), clocks_(clocks) {}

SocketCanBus::~SocketCanBus() { Close(); }

void SocketCanBus::Open(std::span<const std::uint32_t> ids, int bitrate_bps) {
  Close();
  bitrate_bps_ = static_cast<std::uint32_t>(bitrate_bps);
  gone_ = false;
  CheckLink();
  fd_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (fd_ < 0) Fail(interface_, "no CAN socket");
  try {
    Configure(ids);
  } catch (...) {
    Close();
    throw;
  }
  counts_ = {};
  arrivals_.Begin(now_ns());
}

void SocketCanBus::CheckLink() {
  CanLink link{};
  if (!ReadCanLink(interface_, &link)) Fail(interface_, "no such interface");
  const std::optional<LinkProblem> problem = FindProblem(link, bitrate_bps_);
  if (problem) {
    throw HalError(interface_ + ": " + problem->what + ": found " + std::to_string(problem->found) +
                   ", expected " + problem->relation + std::to_string(problem->expected) +
                   problem->why);
  }
  index_ = link.index;
  state_ = link.state;
}

void SocketCanBus::Configure(std::span<const std::uint32_t> ids) {
  filters_.clear();
  for (const std::uint32_t id : ids) {
    filters_.push_back({.can_id = id, .can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG});
  }
  Set(interface_, fd_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, kErrorsWanted,
      "cannot enable error frames");
  Set(interface_, fd_, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, 1, "cannot enable the echo");
  Set(interface_, fd_, SOL_SOCKET, SO_SNDBUF, 1,
      "cannot set the send buffer");  // the kernel's minimum
  Set(interface_, fd_, SOL_SOCKET, SO_RCVBUF, kReceiveBytes, "cannot set the receive buffer");
  Set(interface_, fd_, SOL_SOCKET, SO_TIMESTAMPING,
      static_cast<int>(SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE),
      "cannot enable time stamps");
  if (!Join()) Fail(interface_, "cannot join the bus");
}

bool SocketCanBus::Join() noexcept {
  const auto bytes = static_cast<socklen_t>(filters_.size() * sizeof(can_filter));
  if (setsockopt(fd_, SOL_CAN_RAW, CAN_RAW_FILTER, filters_.data(), bytes) != 0) return false;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index_;
  return bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
}

SendResult SocketCanBus::Send(const CanFrame& frame) noexcept {
  ClassicFrame raw{};
  raw.can_id = frame.id & CAN_SFF_MASK;
  raw.len = std::min<std::uint8_t>(frame.length, CAN_MAX_DLEN);
  std::copy_n(frame.data.begin(), raw.len, raw.data);
  if (send(fd_, &raw, CAN_MTU, MSG_DONTWAIT | MSG_NOSIGNAL) == CAN_MTU) {
    ++counts_.sent;
    return SendResult::kSent;
  }
  if (errno != ENOBUFS && errno != EAGAIN && errno != EINTR) return SendResult::kFailed;
  ++counts_.queue_full;
  return SendResult::kQueueFull;
}

bool SocketCanBus::Receive(ReceivedFrame* received) noexcept {
  const std::int64_t begin_ns = now_ns();
  // Error frames and frames that the filter should not have passed are skipped; a bounded number.
  for (int skipped = 0; skipped < 64; ++skipped) {
    ClassicFrame raw{};
    iovec part{.iov_base = &raw, .iov_len = CAN_MTU};
    alignas(cmsghdr) std::array<char, kControlBytes> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    if (recvmsg(fd_, &message, MSG_DONTWAIT) != CAN_MTU) {
      if (errno == EAGAIN) arrivals_.Emptied(begin_ns);
      gone_ = gone_ || errno == ENODEV;
      return false;
    }
    if ((raw.can_id & CAN_ERR_FLAG) != 0) {
      TakeErrorFrame(raw.can_id, raw.data);
      continue;
    }
    if ((raw.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG)) != 0 || raw.len > CAN_MAX_DLEN) continue;
    const std::int64_t before_ns = clocks_.monotonic_ns(), realtime_ns = clocks_.realtime_ns();
    arrivals_.Take({before_ns, realtime_ns, clocks_.monotonic_ns()});
    *received = ReceivedFrame{.frame = {.id = raw.can_id, .length = raw.len, .data = {}},
                              .at_ns = arrivals_.ArrivalOf(StampOf(&message)),
                              .own = (message.msg_flags & MSG_CONFIRM) != 0};
    std::copy_n(raw.data, raw.len, received->frame.data.begin());
    ++counts_.received;
    return true;
  }
  return false;
}

void SocketCanBus::TakeErrorFrame(std::uint32_t id, const std::uint8_t* data) noexcept {
  ++counts_.error_frames;
  if ((id & CAN_ERR_BUSOFF) != 0) {
    state_ = CanState::kBusOff;
  } else if ((id & CAN_ERR_RESTARTED) != 0) {
    state_ = CanState::kActive;
  } else if ((id & CAN_ERR_CRTL) != 0 && state_ != CanState::kBusOff) {
    constexpr unsigned kPassive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
    state_ = (data[1] & kPassive) != 0 ? CanState::kPassive : CanState::kActive;
  }
}

void SocketCanBus::WaitUntil(std::int64_t instant_ns) noexcept {
  const std::int64_t left_ns = instant_ns - now_ns();
  if (left_ns <= 0) return;
  pollfd ready{.fd = fd_, .events = POLLIN, .revents = 0};
  const timespec timeout{.tv_sec = left_ns / kSecond_ns, .tv_nsec = left_ns % kSecond_ns};
  ppoll(&ready, 1, &timeout, nullptr);
  // An interface that went down is reported on every call: do not spin.
  if ((ready.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0 && (ready.revents & POLLIN) == 0) {
    ppoll(nullptr, 0, &timeout, nullptr);
  }
}

CanState SocketCanBus::state() noexcept {
  if (gone_) return CanState::kDown;  // a query by name would make the kernel load a module
  // The flags are read without netlink's lock; a bus-off controller has no carrier.
  ifreq request{};
  std::copy_n(interface_.c_str(), std::min<std::size_t>(interface_.size(), IFNAMSIZ - 1),
              request.ifr_name);
  if (ioctl(fd_, SIOCGIFFLAGS, &request) != 0) return CanState::kDown;
  const auto flags = static_cast<unsigned>(request.ifr_flags);
  if ((flags & IFF_UP) == 0) return CanState::kDown;
  if ((flags & IFF_RUNNING) == 0) return CanState::kBusOff;
  return state_;
}

bool SocketCanBus::unsent() noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof(memory);
  if (getsockopt(fd_, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0) return false;
  return memory[SK_MEMINFO_WMEM_ALLOC] != 0;
}

bool SocketCanBus::Restart() noexcept {
  if (gone_) {
    // Plugged in again it is another interface with the same name, which the system has to
    // configure. The kernel has dropped the socket's filters with the old one.
    CanLink link{};
    if (!ReadCanLink(interface_, &link) || FindProblem(link, bitrate_bps_)) return false;
    index_ = link.index;
    if (!Join()) return false;
    gone_ = false;
  }
  if (!RestartCanLink(index_)) return false;
  int down = 0;  // the socket keeps "network is down" for its next call: clear it
  socklen_t size = sizeof(down);
  getsockopt(fd_, SOL_SOCKET, SO_ERROR, &down, &size);
  state_ = CanState::kActive;
  return true;
}

void SocketCanBus::Close() noexcept {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
}

}  // namespace flexarm
