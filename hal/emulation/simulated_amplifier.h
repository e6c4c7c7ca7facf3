#pragma once

#include <thread>

#include "hal/emulation/channel_faults.h"
#include "hal/emulation/modbus_server.h"
#include "hal/emulation/register_image.h"

namespace flexarm {

/// A strain amplifier of the emulated rig: its registers, its server on a thread of its own, and
/// its injected faults. Thread: one, besides the server's.
class SimulatedAmplifier {
 public:
  /// Starts the server. @throws HalError
  SimulatedAmplifier(const ModbusDeviceConfig& config, const SensorConfig& sensors);
  ~SimulatedAmplifier();
  SimulatedAmplifier(const SimulatedAmplifier&) = delete;
  SimulatedAmplifier& operator=(const SimulatedAmplifier&) = delete;

  /// Sets the present readings of the gauges.
  void Show(SensorFrame frame) noexcept;

  /// Removes all injected faults.
  void Mend();

  const std::string& name() const noexcept { return name_; }
  ModbusServer& server() noexcept { return server_; }
  ChannelFaults& channels() noexcept { return channels_; }
  /// Swaps the word order of 32-bit values; false if it has none.
  bool SwapWords() noexcept;

 private:
  std::string name_;
  ChannelFaults channels_;
  RegisterImage image_;
  ModbusServer server_;
  std::thread thread_;
};

}  // namespace flexarm
