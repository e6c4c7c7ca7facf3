#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "hal/emulation/modbus_server.h"
#include "tests/hal/modbus/modbus_testing.h"

namespace flexarm {

/// The rig's server as a peer of the driver: it has the identification of Amplifier(), one reading
/// in every input register and 1 in every discrete input, and injects faults. Each call returns
/// when its fault is in effect.
class HostilePeer {
 public:
  /// TCP: any free port of the loopback. RTU: a pseudo-terminal behind a link.
  explicit HostilePeer(ModbusTransport transport) : config_(ConfigFor(transport)) {
    thread_ = std::jthread([this] { server_.Run(); });
  }
  ~HostilePeer() {
    server_.Stop();
    thread_.join();
  }
  HostilePeer(const HostilePeer&) = delete;
  HostilePeer& operator=(const HostilePeer&) = delete;

  int port() const { return server_.port(); }
  const std::string& path() const { return config_.device; }

  void Behave(WireFault how) {
    server_.Behave(how, std::chrono::hours(1));
    Settle();
  }
  void Show(std::uint16_t reading) {
    SensorFrame frame{};
    frame.strain.fill(reading);
    frame.levels = ~LineLevels{0};
    image_.Publish(frame);
  }
  /// Sends the replies that kLate held back, before it returns.
  void ReleaseHeld() {
    server_.ReleaseLate();
    Settle();
  }
  /// Unplugs the device: connection, listener or terminal closed.
  void Leave() { Behave(WireFault::kAway); }
  /// Plugs it in again, at the same address.
  void Return() { Behave(WireFault::kNone); }

  int requests() const { return static_cast<int>(server_.requests()); }
  std::int64_t bytes_flooded() const { return server_.bytes_flooded(); }

 private:
  static ModbusDeviceConfig ConfigFor(ModbusTransport transport) {
    ModbusDeviceConfig config =
        transport == ModbusTransport::kTcp
            ? Amplifier()
            : SerialAmplifier(testing::TempDir() + "/flexarm-hostile-" + std::to_string(getpid()));
    config.port = 0;
    return config;
  }
  void Settle() const {
    while (!server_.settled()) std::this_thread::sleep_for(std::chrono::microseconds(100));
  }

  ModbusDeviceConfig config_;
  RegisterImage image_{config_};
  ModbusServer server_{config_, image_};
  std::jthread thread_;
};

}  // namespace flexarm
