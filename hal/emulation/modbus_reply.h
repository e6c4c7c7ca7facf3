#pragma once

#include <cstdint>
#include <vector>

#include "hal/emulation/register_image.h"
#include "hal/emulation/wire_fault.h"
#include "hal/modbus/modbus_config.h"

namespace flexarm {

using ModbusBytes = std::vector<std::uint8_t>;

/// Length in bytes of the request at the start of `received`: 0 if it is incomplete, -1 if it is
/// not a request (RTU: or its checksum is wrong).
int RequestLength(ModbusTransport transport, const ModbusBytes& received);

/// The reply frame of a device to a complete request: its registers, or an exception. Empty: a
/// serial device does not answer for another unit. Composed of bytes, without libmodbus and without
/// the driver, so that the test is independent of their errors.
/// @param fault  injected fault: those that change bytes act here, the others do not
ModbusBytes ReplyFrame(const ModbusDeviceConfig& config, const RegisterImage& image,
                       const ModbusBytes& request, WireFault fault);

}  // namespace flexarm
