#pragma once

#include <cstdint>
#include <string>

#include "controller/runlog/file_descriptor.h"

namespace flexarm {

/// Where the server listens.
struct ListenAddress {
  std::string ip = "127.0.0.1";  ///< one address of this computer, IPv4 or IPv6, without brackets
  std::uint16_t port = 8080;     ///< 0: the kernel chooses one

  /// Whether only this computer reaches it: 127.0.0.0/8 and ::1.
  /// @throws InputError: `ip` is no address, or stands for all of this computer
  bool IsLoopback() const;

  /// "127.0.0.1:8080", "[::1]:8080": as it stands in a URL and in the header Host.
  std::string Text() const;
};

/// Opens the listening socket, and sets the port that was chosen. What one client has not yet read
/// is kept small, so that a slow one neither takes memory nor shows what is old.
/// @throws InputError saying what to do: the port is taken, or the address is not of this computer
FileDescriptor Listen(ListenAddress* address);

}  // namespace flexarm
