#pragma once

#include <cstdint>

namespace flexarm {

/// ioctl(2), or what a test puts in its place.
using IoctlCall = int (*)(int fd, unsigned long request, void* argument);

/// What became of a serial port's latency.
enum class SerialLatency : std::uint8_t {
  kLow,      ///< set, and read back
  kNoWire,   ///< a pseudo-terminal: there is no adapter and no latency
  kRefused,  ///< the port does not know the flag, or forgets it
};

/// Asks a serial port to hand on each byte at once. A USB adapter otherwise collects them for up to
/// 16 ms, most of a period.
///
/// An adapter that has no such flag may be quick all the same, but nobody can tell: it is refused.
/// Real-time: system calls only.
SerialLatency SetLowLatency(int fd, IoctlCall call) noexcept;

/// The kernel's own.
int KernelIoctl(int fd, unsigned long request, void* argument) noexcept;

}  // namespace flexarm
