#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/modbus/modbus_config.h"

namespace flexarm {

/// One read request, and the rows of the map that it serves.
struct ModbusRequest {
  ModbusTable table;
  int address;
  int count;  ///< registers or bits
  std::vector<int>
      rows;  ///< rows of ModbusDeviceConfig::map; of identification for an identity check
  std::int64_t silent_ns;  ///< RTU: silence on the line before the request
  std::int64_t reply_ns;   ///< time-out of the whole reply after the request is sent
  std::int64_t worst_ns;   ///< bound of the request, including silence and overhead
};

/// The requests of a device, and their time bounds.
///
/// Adjacent rows, and rows at most `gap_limit` addresses apart, share a request up to the limits of
/// a frame (125 registers, 2000 bits): the fewest requests possible under that limit. A 32-bit
/// value is never split, so it cannot be torn.
/// TCP: a request is bounded by its response time-out. RTU: by the time of both frames on the wire
/// and 3.5 characters of silence before each (1.75 ms above 19200 baud; Modbus over serial line
/// V1.02, 2.5.1.1), and the response time-out.
struct ModbusPlan {
  std::vector<ModbusRequest> proofs;  ///< identity check
  std::vector<ModbusRequest> reads;   ///< one exchange
  std::int64_t exchange_worst_ns;     ///< RTU: with one identity check, which follows a failure
  std::int64_t reconnect_worst_ns;    ///< connecting, and the whole identity check
};

/// Time of one channel, for the list of the config check.
struct ModbusChannelCost {
  std::string channel;  ///< "strain[3]", "reset-button"
  int request;          ///< index in ModbusPlan::reads; channels of the same request share its time
  std::int64_t worst_ns;  ///< of that request
};

/// @param config  without problems. Allocates: start-up only.
ModbusPlan PlanModbus(const ModbusDeviceConfig& config);

/// Times of all channels, in the order of the map.
std::vector<ModbusChannelCost> ChannelCosts(const ModbusDeviceConfig& config);

}  // namespace flexarm
