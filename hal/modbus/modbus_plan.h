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
  int count;               ///< registers or bits
  std::vector<int> rows;   ///< rows of ModbusDeviceConfig::map; of identification for a proof
  std::int64_t silent_ns;  ///< RTU: the line must be silent for so long before it
  std::int64_t reply_ns;   ///< the whole reply must be here so long after the request is sent
  std::int64_t worst_ns;   ///< bound of the request, waiting for silence and overhead included
};

/// The requests of a device, and what they may take.
///
/// Adjacent rows, and rows at most `gap_limit` addresses apart, share a request as far as a frame
/// reaches (125 registers, 2000 bits): these are the fewest requests possible under that limit. A
/// 32-bit value is never split, so it cannot be torn.
/// TCP: a request is bounded by its response time-out. RTU: by the time of both frames on the wire
/// and 3.5 characters of silence before each (1.75 ms above 19200 baud; Modbus over serial line
/// V1.02, 2.5.1.1), and the response time-out.
struct ModbusPlan {
  std::vector<ModbusRequest> proofs;  ///< identification
  std::vector<ModbusRequest> reads;   ///< one exchange
  std::int64_t exchange_worst_ns;     ///< RTU: with one proof, which follows a failure
  std::int64_t reconnect_worst_ns;    ///< connecting, and all proofs
};

/// What one channel costs, for the config check's list.
struct ModbusChannelCost {
  std::string channel;    ///< "strain[3]", "reset-button"
  int request;            ///< index in ModbusPlan::reads; channels with the same one share its time
  std::int64_t worst_ns;  ///< of that request
};

/// @param config  without problems. Allocates: start-up only.
ModbusPlan PlanModbus(const ModbusDeviceConfig& config);

/// In the order of the map.
std::vector<ModbusChannelCost> ChannelCosts(const ModbusDeviceConfig& config);

}  // namespace flexarm
