#include "hal/canopen/can_link.h"

#include <linux/can/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>

namespace flexarm {
namespace {

constexpr int kAnswer_ms = 100;
// IFF_ECHO of linux/if.h, which cannot be included together with net/if.h.
constexpr unsigned kEchoFlag = 1U << 18U;

struct Request {
  nlmsghdr header;
  ifinfomsg link;
};

// Each answer is one datagram.
class RouteSocket {
 public:
  RouteSocket() : fd_(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)) {}
  ~RouteSocket() {
    if (fd_ >= 0) close(fd_);
  }
  RouteSocket(const RouteSocket&) = delete;
  RouteSocket& operator=(const RouteSocket&) = delete;

  // The answer's bytes in `answer`; 0 if there was none.
  std::size_t Ask(const Request& request) noexcept {
    pollfd ready{.fd = fd_, .events = POLLIN, .revents = 0};
    if (fd_ < 0 || send(fd_, &request, sizeof(request), 0) < 0) return 0;
    if (poll(&ready, 1, kAnswer_ms) != 1) return 0;
    const ssize_t size = recv(fd_, answer.data(), answer.size(), MSG_DONTWAIT);
    return size < 0 ? 0 : static_cast<std::size_t>(size);
  }

  alignas(nlmsghdr) std::array<char, 16384> answer{};

 private:
  int fd_;
};

Request Make(std::uint16_t type, std::uint16_t flags, int index) noexcept {
  Request request{};
  request.header.nlmsg_len = sizeof(request);
  request.header.nlmsg_type = type;
  request.header.nlmsg_flags = static_cast<std::uint16_t>(NLM_F_REQUEST | flags);
  request.link.ifi_family = AF_UNSPEC;
  request.link.ifi_index = index;
  return request;
}

using Bytes = std::span<const char>;

template <typename Value>
Value Read(Bytes bytes) noexcept {
  Value value{};
  std::memcpy(&value, bytes.data(), std::min(sizeof(value), bytes.size()));
  return value;
}

// Calls take(type, payload) for each attribute.
template <typename Take>
void ForEach(Bytes bytes, const Take& take) noexcept {
  while (bytes.size() >= sizeof(rtattr)) {
    const auto head = Read<rtattr>(bytes);
    if (head.rta_len < sizeof(rtattr) || head.rta_len > bytes.size()) return;
    take(head.rta_type & NLA_TYPE_MASK,
         bytes.subspan(sizeof(rtattr), head.rta_len - sizeof(rtattr)));
    bytes = bytes.subspan(std::min<std::size_t>(RTA_ALIGN(head.rta_len), bytes.size()));
  }
}

CanState StateOf(std::uint32_t kernel_state) noexcept {
  switch (kernel_state) {
    case CAN_STATE_ERROR_ACTIVE:
    case CAN_STATE_ERROR_WARNING:
      return CanState::kActive;
    case CAN_STATE_ERROR_PASSIVE:
      return CanState::kPassive;
    case CAN_STATE_BUS_OFF:
      return CanState::kBusOff;
    default:
      return CanState::kDown;
  }
}

void ReadController(Bytes data, CanLink* link) noexcept {
  ForEach(data, [link](int type, Bytes value) {
    if (type == IFLA_CAN_STATE) link->state = StateOf(Read<std::uint32_t>(value));
    if (type == IFLA_CAN_RESTART_MS) link->restart_ms = Read<std::uint32_t>(value);
    if (type == IFLA_CAN_BITTIMING) link->bitrate_bps = Read<can_bittiming>(value).bitrate;
  });
}

void ReadLinkInfo(Bytes info, CanLink* link) noexcept {
  Bytes data;
  ForEach(info, [&](int type, Bytes value) {
    if (type == IFLA_INFO_KIND) {
      link->controller = std::string_view(value.data(), value.size()).starts_with("can");
    }
    if (type == IFLA_INFO_DATA) data = value;
  });
  if (link->controller) ReadController(data, link);
}

}  // namespace

bool ReadCanLink(const std::string& interface, CanLink* link) noexcept {
  *link = CanLink{};
  link->state = CanState::kActive;
  link->index = static_cast<int>(if_nametoindex(interface.c_str()));
  if (link->index == 0) return false;
  RouteSocket route;
  const std::size_t size = route.Ask(Make(RTM_GETLINK, 0, link->index));
  nlmsghdr header{};
  if (size < sizeof(Request)) return false;
  std::memcpy(&header, route.answer.data(), sizeof(header));
  if (header.nlmsg_type != RTM_NEWLINK || header.nlmsg_len > size ||
      header.nlmsg_len < sizeof(Request)) {
    return false;
  }
  const Bytes answer = Bytes(route.answer).first(header.nlmsg_len);
  const unsigned flags = Read<ifinfomsg>(answer.subspan(sizeof(header))).ifi_flags;
  link->up = (flags & IFF_UP) != 0;
  link->echo = (flags & kEchoFlag) != 0;
  ForEach(answer.subspan(sizeof(Request)), [link](int type, Bytes value) {
    if (type == IFLA_TXQLEN) link->transmit_queue = Read<std::uint32_t>(value);
    if (type == IFLA_LINKINFO) ReadLinkInfo(value, link);
  });
  if (!link->up) link->state = CanState::kDown;
  return true;
}

bool RestartCanLink(int index) noexcept {
  RouteSocket route;
  for (const unsigned flags : {0U, static_cast<unsigned>(IFF_UP)}) {
    Request request = Make(RTM_NEWLINK, NLM_F_ACK, index);
    request.link.ifi_change = IFF_UP;
    request.link.ifi_flags = flags;
    const std::size_t size = route.Ask(request);
    nlmsgerr error{};
    if (size < sizeof(nlmsghdr) + sizeof(error.error)) return false;
    std::memcpy(&error.error, route.answer.data() + sizeof(nlmsghdr), sizeof(error.error));
    if (error.error != 0) {
      errno = -error.error;
      return false;
    }
  }
  return true;
}

}  // namespace flexarm
