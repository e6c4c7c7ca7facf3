#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <string>

namespace flexarm {

/// The address of a Unix socket, as the socket calls take it.
class UnixAddress {
 public:
  /// @throws RejectedError if `path` is empty or longer than the system allows (107 characters)
  explicit UnixAddress(const std::string& path);

  const sockaddr* get() const noexcept;
  socklen_t size() const noexcept { return sizeof(address_); }

 private:
  sockaddr_un address_{};
};

}  // namespace flexarm
