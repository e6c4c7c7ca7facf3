#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/canopen/canopen_device.h"
#include "hal/emulation/memory_bus.h"
#include "hal/emulation/simulated_node.h"
#include "tests/support/loop_time.h"

namespace flexarm {

inline CanopenNodeConfig BenchDrive(CanopenRole role, int node_id) {
  const bool first = role == CanopenRole::kDrive1;
  return {.role = role,
          .node_id = node_id,
          .vendor = 0x2EF,
          .product = 0x1234,
          .serial = 0,
          .torque_per_mille_nm = first ? 0.03 : 0.006,
          .sign = first ? 1 : -1,
          .torque_range_nm = first ? 36.0 : 7.2,
          .gear = first ? 5.0 : 48.96,
          .position_is_rotor = false};
}

inline CanopenNodeConfig BenchEncoder(CanopenRole role, int node_id) {
  return {.role = role,
          .node_id = node_id,
          .vendor = 0x42,
          .product = 0x58,
          .serial = 0,
          .torque_per_mille_nm = 0.0,
          .sign = 0,
          .torque_range_nm = 0.0,
          .gear = 0.0,
          .position_is_rotor = false};
}

/// The thesis rig's two gears on one bus with four encoders, at 1 Mbit/s and 50 Hz.
inline CanopenConfig BenchConfig() {
  return {.interface = "can0",
          .bitrate_bps = 1'000'000,
          .period_ms = 20.0,
          .master_node_id = 127,
          .answer_timeout_ms = 5.0,
          .sdo_timeout_ms = 20,
          .boot_timeout_ms = 500,
          .node_heartbeat_ms = 50,
          .node_timeout_ms = 120,
          .master_timeout_ms = 60,
          .node = {BenchDrive(CanopenRole::kDrive1, 1), BenchDrive(CanopenRole::kDrive2, 2),
                   BenchEncoder(CanopenRole::kHub1, 11), BenchEncoder(CanopenRole::kHub2, 12),
                   BenchEncoder(CanopenRole::kRotor1, 13), BenchEncoder(CanopenRole::kRotor2, 14)}};
}

/// A device on a bus in memory with the nodes of its config, in virtual time.
class CanopenBench {
 public:
  static constexpr std::size_t kNodes = 6;
  static constexpr std::int64_t kPeriod_ns = 20 * kMs;
  static constexpr BusCommand kOff{.torque_nm = {}, .enabled = false};
  static constexpr BusCommand kAcknowledge{.torque_nm = {}, .enabled = false, .acknowledge = true};

  /// @param wired  the actual nodes on the wire, in the order of the config's nodes
  explicit CanopenBench(const CanopenConfig& config = BenchConfig(),
                        std::vector<SimulatedNodeConfig> wired = Wired(BenchConfig())) {
    for (const SimulatedNodeConfig& node : wired) {
      ends_.push_back(std::make_unique<MemoryBus>(&wire));
      nodes_.push_back(std::make_unique<SimulatedNode>(ends_.back().get(), node));
      SimulatedNode* started = nodes_.back().get();
      started->Start();
      wire.AddRunner([started] { started->Run(); });
    }
    auto bus = std::make_unique<MemoryBus>(&wire, "can0");
    master = bus.get();
    device = std::make_unique<CanopenDevice>(config, std::move(bus));
    spy.OpenForAll();
    wire.AdvanceTo(10 * kMs);
  }

  static std::vector<SimulatedNodeConfig> Wired(const CanopenConfig& config) {
    std::vector<SimulatedNodeConfig> wired;
    for (const CanopenNodeConfig& node : config.node) {
      wired.push_back(SimulatedNodeOf(node));
      wired.back().serial = 7;
    }
    return wired;
  }

  SimulatedNode& node(std::size_t i) { return *nodes_[i]; }
  std::int64_t now_ns() const { return wire.now_ns(); }

  /// Advances to the next instant of the grid, then makes one exchange.
  BusStatus Exchange(const BusCommand& command) {
    NextPeriod();
    return device->Exchange(command, &frame);
  }
  /// One step back from a failure, with the operator's acknowledgement of drive faults.
  BusStatus Recover() {
    NextPeriod();
    return device->needs_reconnect() ? device->Reconnect() : device->Exchange(kAcknowledge, &frame);
  }
  void NextPeriod() { wire.AdvanceTo((now_ns() / kPeriod_ns + 1) * kPeriod_ns); }

  /// Opens the device and enables both drives. True on success.
  bool Enable(const BusCommand& command = {.torque_nm = {}, .enabled = true}) {
    device->Open();
    return EnableOpened(command);
  }
  bool EnableOpened(const BusCommand& command = {.torque_nm = {}, .enabled = true}) {
    for (int k = 0; k < 8; ++k) {
      if (Exchange(command) != BusStatus::kOk) return false;
    }
    return node(0).state() == DriveState::kOperationEnabled &&
           node(1).state() == DriveState::kOperationEnabled;
  }

  /// Last result of Recover, after at most `attempts` calls.
  BusStatus RecoverUntilOk(int attempts) {
    BusStatus status = BusStatus::kTimeout;
    for (int k = 0; k < attempts && status != BusStatus::kOk; ++k) status = Recover();
    return status;
  }

  /// The frames on the wire since the last call.
  std::vector<ReceivedFrame> Heard() {
    std::vector<ReceivedFrame> heard;
    ReceivedFrame received{};
    while (spy.Receive(&received)) heard.push_back(received);
    return heard;
  }

  MemoryWire wire{1'000'000};
  MemoryBus spy{&wire};
  MemoryBus* master = nullptr;
  std::unique_ptr<CanopenDevice> device;
  SensorFrame frame{};

 private:
  std::vector<std::unique_ptr<MemoryBus>> ends_;
  std::vector<std::unique_ptr<SimulatedNode>> nodes_;
};

}  // namespace flexarm
