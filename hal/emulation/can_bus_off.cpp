#include "hal/emulation/can_bus_off.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

namespace flexarm {

bool AnnounceBusOff(const std::string& interface) noexcept {
  const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
  if (fd < 0) return false;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  canfd_frame frame{};  // its first CAN_MTU bytes are a classic one
  frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
  frame.len = CAN_ERR_DLC;
  const bool sent = address.can_ifindex != 0 &&
                    bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 &&
                    write(fd, &frame, CAN_MTU) == CAN_MTU;
  close(fd);
  return sent;
}

}  // namespace flexarm
