#pragma once

#include <cstdint>

namespace flexarm {

/// ioctl(2), or a replacement in tests.
using IoctlCall = int (*)(int fd, unsigned long request, void* argument);

/// Result of setting a serial port's latency.
enum class SerialLatency : std::uint8_t {
  kLow,      ///< set, and read back
  kNoWire,   ///< a pseudo-terminal: there is no adapter and no latency
  kRefused,  ///< the port does not support the flag, or does not keep it
};

/// Sets a serial port to deliver each byte immediately. A USB adapter otherwise collects bytes for
/// up to 16 ms, most of a period.
///
/// An adapter without that flag may be fast, but that cannot be verified: it is rejected.
/// Real-time: system calls only.
SerialLatency SetLowLatency(int fd, IoctlCall call) noexcept;

/// The kernel's ioctl(2).
int KernelIoctl(int fd, unsigned long request, void* argument) noexcept;

}  // namespace flexarm
