#pragma once

#include <thread>

#include "hal/emulation/channel_faults.h"
#include "hal/emulation/modbus_server.h"
#include "hal/emulation/register_image.h"

namespace flexarm {

/// A strain amplifier of the simulated rig: its registers, its server on a thread of its own, and
/// what is wrong with it. Thread: one, besides the server's.
class SimulatedAmplifier {
 public:
  /// Serves at once. @throws HalError
  SimulatedAmplifier(const ModbusDeviceConfig& config, const SensorConfig& sensors);
  ~SimulatedAmplifier();
  SimulatedAmplifier(const SimulatedAmplifier&) = delete;
  SimulatedAmplifier& operator=(const SimulatedAmplifier&) = delete;

  /// What the gauges say now.
  void Show(SensorFrame frame) noexcept;

  /// Everything well again.
  void Mend();

  const std::string& name() const noexcept { return name_; }
  ModbusServer& server() noexcept { return server_; }
  ChannelFaults& channels() noexcept { return channels_; }
  /// 32-bit values in the wrong word order; false if it has none.
  bool SwapWords() noexcept;

 private:
  std::string name_;
  ChannelFaults channels_;
  RegisterImage image_;
  ModbusServer server_;
  std::thread thread_;
};

}  // namespace flexarm
