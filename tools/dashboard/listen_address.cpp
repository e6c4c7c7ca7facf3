#include "tools/dashboard/listen_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "controller/files/external_text.h"
#include "controller/files/input_error.h"

namespace flexarm {
namespace {

constexpr int kBacklog = 256;
constexpr int kSendBufferBytes = 64 << 10;  // a few messages; the kernel doubles it

/// An address as the system calls have it.
struct SystemAddress {
  explicit SystemAddress(const ListenAddress& address) {
    if (inet_pton(AF_INET, address.ip.c_str(), &v4.sin_addr) == 1) {
      v4.sin_family = AF_INET;
      v4.sin_port = htons(address.port);
    } else if (inet_pton(AF_INET6, address.ip.c_str(), &v6.sin6_addr) == 1) {
      is_v6 = true;
      v6.sin6_family = AF_INET6;
      v6.sin6_port = htons(address.port);
    } else {
      throw InputError("--bind: " + Shown(address.ip, kMessageBytes) +
                       " is no address; expected one such as 127.0.0.1 or ::1");
    }
  }

  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the interface of the system
  sockaddr* get() {
    return is_v6 ? reinterpret_cast<sockaddr*>(&v6) : reinterpret_cast<sockaddr*>(&v4);
  }
  socklen_t size() const { return is_v6 ? sizeof v6 : sizeof v4; }
  int family() const { return is_v6 ? AF_INET6 : AF_INET; }
  std::uint16_t port() const { return ntohs(is_v6 ? v6.sin6_port : v4.sin_port); }
  bool is_any() const {
    return is_v6 ? IN6_IS_ADDR_UNSPECIFIED(&v6.sin6_addr) : v4.sin_addr.s_addr == INADDR_ANY;
  }
  bool is_loopback() const {
    return is_v6 ? IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr) : ntohl(v4.sin_addr.s_addr) >> 24U == 127U;
  }

  bool is_v6 = false;
  sockaddr_in v4{};
  sockaddr_in6 v6{};
};

void Set(const FileDescriptor& socket, int level, int option, int value) {
  setsockopt(socket.get(), level, option, &value, sizeof value);
}

}  // namespace

bool ListenAddress::IsLoopback() const {
  const SystemAddress address(*this);
  if (address.is_any()) {
    throw InputError("--bind: " + ip +
                     " stands for every address of this computer; name one, so that the header "
                     "Host of a request can be checked");
  }
  return address.is_loopback();
}

std::string ListenAddress::Text() const {
  const bool is_v6 = ip.find(':') != std::string::npos;
  return (is_v6 ? "[" + ip + "]" : ip) + ":" + std::to_string(port);
}

FileDescriptor Listen(ListenAddress* address) {
  SystemAddress wanted(*address);
  FileDescriptor listener(socket(wanted.family(), SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  Set(listener, SOL_SOCKET, SO_REUSEADDR, 1);
  Set(listener, SOL_SOCKET, SO_SNDBUF, kSendBufferBytes);  // connections inherit it
  if (wanted.is_v6) Set(listener, IPPROTO_IPV6, IPV6_V6ONLY, 1);
  socklen_t size = wanted.size();
  const bool listens = bind(listener.get(), wanted.get(), size) == 0 &&
                       listen(listener.get(), kBacklog) == 0 &&
                       getsockname(listener.get(), wanted.get(), &size) == 0;
  if (!listens) {
    const int error = errno;
    const std::string what = address->Text() + ": cannot listen (" + std::strerror(error) + ")";
    if (error == EADDRINUSE)
      throw InputError(what + "; name another with --port, or 0 for a free one");
    if (error == EACCES) throw InputError(what + "; ports below 1024 are root's: --port 8080");
    throw InputError(what + "; --bind names an address of this computer");
  }
  address->port = wanted.port();
  return listener;
}

}  // namespace flexarm
