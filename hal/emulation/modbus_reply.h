#pragma once

#include <cstdint>
#include <vector>

#include "hal/emulation/register_image.h"
#include "hal/emulation/wire_fault.h"
#include "hal/modbus/modbus_config.h"

namespace flexarm {

using ModbusBytes = std::vector<std::uint8_t>;

/// Bytes of the request that `received` begins with: 0 if it is not all there yet, -1 if no request
/// begins like that (RTU: or its checksum is wrong).
int RequestLength(ModbusTransport transport, const ModbusBytes& received);

/// The frame with which a device answers a whole request: its registers, or an exception. Empty: a
/// serial device does not answer for another unit. Made of bytes, without libmodbus and without the
/// driver, so that a mistake of theirs is not ours too.
/// @param fault  what is wrong with it: those that change bytes act here, the others do not
ModbusBytes ReplyFrame(const ModbusDeviceConfig& config, const RegisterImage& image,
                       const ModbusBytes& request, WireFault fault);

}  // namespace flexarm
