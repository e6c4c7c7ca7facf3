#include "hal/modbus/serial_latency.h"

#include <linux/serial.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

namespace flexarm {
namespace {

// Documentation/admin-guide/devices.txt: Unix98 pseudo-terminal slaves.
constexpr unsigned kFirstPtyMajor = 136;
constexpr unsigned kLastPtyMajor = 143;
constexpr int kLowLatency = 1 << ASYNCB_LOW_LATENCY;  // serial_struct::flags is an int

bool IsPseudoTerminal(int fd) noexcept {
  struct stat status{};
  if (fstat(fd, &status) != 0 || !S_ISCHR(status.st_mode)) return false;
  const unsigned number = major(status.st_rdev);
  return number >= kFirstPtyMajor && number <= kLastPtyMajor;
}

}  // namespace

SerialLatency SetLowLatency(int fd, IoctlCall call) noexcept {
  if (IsPseudoTerminal(fd)) return SerialLatency::kNoWire;
  serial_struct port{};
  if (call(fd, TIOCGSERIAL, &port) != 0) return SerialLatency::kRefused;
  port.flags |= kLowLatency;
  if (call(fd, TIOCSSERIAL, &port) != 0) return SerialLatency::kRefused;
  serial_struct found{};
  const bool kept = call(fd, TIOCGSERIAL, &found) == 0 && (found.flags & kLowLatency) != 0;
  return kept ? SerialLatency::kLow : SerialLatency::kRefused;
}

int KernelIoctl(int fd, unsigned long request, void* argument) noexcept {
  return ioctl(fd, request, argument);
}

}  // namespace flexarm
