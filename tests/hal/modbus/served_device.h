#pragma once

#include <chrono>
#include <thread>

#include "hal/emulation/modbus_server.h"
#include "hal/emulation/register_image.h"
#include "tests/hal/modbus/modbus_testing.h"

namespace flexarm {

/// Our own server on its own thread, and the config for a driver that connects to it.
class ServedDevice {
 public:
  explicit ServedDevice(ModbusDeviceConfig config)
      : config_(Free(std::move(config))), image(config_), server(config_, image) {
    config_.port = server.port();
    if (config_.transport == ModbusTransport::kRtu) config_.device = server.path();
    thread_ = std::jthread([this] { server.Run(); });
  }
  ~ServedDevice() {
    server.Stop();
    thread_.join();
  }
  ServedDevice(const ServedDevice&) = delete;
  ServedDevice& operator=(const ServedDevice&) = delete;

  const ModbusDeviceConfig& config() const { return config_; }

  /// In effect when this returns.
  void SetSilent(bool silent) {
    server.Behave(silent ? WireFault::kSilent : WireFault::kNone);
    while (!server.settled()) std::this_thread::sleep_for(std::chrono::microseconds(100));
  }

 private:
  // Any port, no link; and enough time for an ordinary thread on a loaded machine.
  static ModbusDeviceConfig Free(ModbusDeviceConfig config) {
    config.port = 0;
    config.device.clear();
    config.response_timeout_ms = 500.0;
    return config;
  }

  ModbusDeviceConfig config_;

 public:
  RegisterImage image;
  ModbusServer server;

 private:
  std::jthread thread_;
};

}  // namespace flexarm
