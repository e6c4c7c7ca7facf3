#pragma once

#include <string>

namespace flexarm {

/// Reports bus-off to every socket of a virtual CAN interface, by an error frame as a hardware
/// driver sends it. The virtual interface still carries frames. False, with errno, if it cannot be
/// sent. Emulated rig only.
bool AnnounceBusOff(const std::string& interface) noexcept;

}  // namespace flexarm
