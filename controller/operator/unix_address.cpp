#include "controller/operator/unix_address.h"

#include <algorithm>
#include <iterator>

#include "controller/types/rejected_error.h"

namespace flexarm {

UnixAddress::UnixAddress(const std::string& path) {
  address_.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof(address_.sun_path)) {
    throw RejectedError("daemon.socket = " + path + ": must be a path of 1 to " +
                        std::to_string(sizeof(address_.sun_path) - 1) + " characters");
  }
  std::copy(path.begin(), path.end(), std::begin(address_.sun_path));
}

const sockaddr* UnixAddress::get() const noexcept {
  return reinterpret_cast<const sockaddr*>(&address_);  // what the socket calls take
}

}  // namespace flexarm
