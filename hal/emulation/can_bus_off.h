#pragma once

#include <string>

namespace flexarm {

/// Has every socket of a virtual CAN interface told that its controller has left the bus, as the
/// driver of a real one tells it: by an error frame. A virtual interface carries frames all the
/// same. False, with errno, if it cannot be sent. Simulated rig only.
bool AnnounceBusOff(const std::string& interface) noexcept;

}  // namespace flexarm
