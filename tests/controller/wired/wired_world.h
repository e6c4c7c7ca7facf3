#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "config/config.h"
#include "controller/realtime/task.h"
#include "hal/canopen/canopen_device.h"
#include "hal/canopen/canopen_wiring.h"
#include "hal/emulation/memory_bus.h"
#include "hal/emulation/simulated_amplifier.h"
#include "hal/emulation/simulated_node.h"
#include "hal/modbus/modbus_wiring.h"
#include "hal/safety_lines.h"
#include "hal/sim/simulated_rig.h"
#include "tests/controller/wired/blocking_executor.h"

// The rig of config/hil-wire.toml without the kernel's CAN and GPIO, so that the test sets its
// time.

namespace flexarm {

/// The switches, the button, the relay and the charge pump.
class WorldLines final : public SafetyLines {
 public:
  Reading Read(std::int64_t) noexcept override {
    const RelayContact contact = relay || welded ? RelayContact::kClosed : RelayContact::kOpen;
    return {.levels = levels, .call = read, .relay = has_contact ? contact : RelayContact::kNone};
  }
  Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept override {
    if (!write.ok) return write;  // the lines keep their levels
    relay = outputs.relay_closed;
    if (outputs.pump_level != pump_) pump_toggled_ns_ = now_ns;
    pump_ = outputs.pump_level;
    return write;
  }
  void HoldOff() noexcept override { write.ok = relay = false; }
  bool PowerOn(std::int64_t now_ns) const {
    const bool pumped = now_ns - pump_toggled_ns_ <= SafetyLines::kPumpTimeoutNs;
    return (relay || welded) && (pumped || pump_stuck);
  }

  LineLevels levels = kHealthyLevels;
  Call read, write;  // how the calls go
  bool relay = false;
  bool welded = false;       // its contact does not open
  bool pump_stuck = false;   // the monostable of the charge pump stays on
  bool has_contact = false;  // a mirror contact

 private:
  bool pump_ = false;
  std::int64_t pump_toggled_ns_ = -1'000'000'000;
};

/// Nodes on a CAN bus in memory, amplifiers behind real sockets, and the simulated arm between
/// them, in steps of a millisecond, after all other tasks that are due in it.
class WiredWorld final : public Task {
 public:
  /// Readings of the gauges and counters from an instant on.
  struct Shown {
    std::int64_t from_ns;
    SensorFrame frame;
  };

  /// @param supply  of the drives; none: they are always supplied
  WiredWorld(const RigConfig& config, BlockingExecutor* executor,
             const std::optional<DriveSupplyModel>& supply = std::nullopt)
      : executor_(executor), rig_(config.arm, config.sensors, config.sim), supply_(supply) {
    const CanopenConfig can = ConfigsOf<CanopenWiring>(config.hal).at(0);
    for (const CanopenNodeConfig& node : can.node) AddNode(node);
    for (const ModbusDeviceConfig& device : ConfigsOf<ModbusWiring>(config.hal)) {
      amplifiers.push_back(std::make_unique<SimulatedAmplifier>(device, config.sensors));
    }
    Show(0);
    for (const auto& amplifier : amplifiers) Settle(amplifier.get());
  }

  Traits traits() const noexcept override {
    return {.name = "world",
            .period_ns = kSliceNs,
            .phase_ns = 0,
            .deadline_ns = kSliceNs,
            .priority = 1};
  }

  void Run(const Activation& activation) noexcept override {
    wire.AdvanceTo(monotonic_ns());
    std::array<double, 2> torque_nm{};
    for (const Node& node : nodes_) {
      node.node->Feed(lines.PowerOn(activation.due_ns) && !supply_fails);
      if (!IsDrive(node.config.role) || !lines.PowerOn(activation.due_ns)) continue;
      torque_nm[static_cast<std::size_t>(node.config.role)] =
          node.config.sign * node.node->torque_per_mille() * node.config.torque_per_mille_nm;
    }
    rig_.SetTorque(torque_nm);
    for (std::int64_t t = 0; t < kSliceNs; t += rig_.step_ns()) rig_.Step();
    Show(activation.due_ns);
  }

  std::int64_t monotonic_ns() const { return executor_->now_ns() + epoch_ns; }

  SimulatedNode& node(CanopenRole role) {
    for (Node& node : nodes_) {
      if (node.config.role == role) return *node.node;
    }
    std::abort();
  }
  std::array<double, 2> hub_angle_rad() const { return rig_.truth().hub_angle_rad; }
  bool drives_make_torque() {
    return node(CanopenRole::kDrive1).torque_per_mille() != 0 ||
           node(CanopenRole::kDrive2).torque_per_mille() != 0;
  }

  /// Whether strain row `i` read `counts` at `instant_ns`, or just before.
  bool Showed(std::size_t i, std::int32_t counts, std::int64_t instant_ns) const {
    return WasThere(instant_ns, [&](const SensorFrame& f) { return f.strain[i] == counts; });
  }
  bool CounterWas(std::size_t i, std::uint32_t counts, std::int64_t instant_ns) const {
    return WasThere(instant_ns, [&](const SensorFrame& f) { return f.counter[i] == counts; });
  }

  /// Waits until the amplifier's server has applied its settings.
  static void Settle(SimulatedAmplifier* amplifier) {
    while (!amplifier->server().settled()) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }

  std::int64_t epoch_ns = 0;  ///< instant 0 of the loop, in the time of the wire
  MemoryWire wire{1'000'000};
  std::vector<std::unique_ptr<SimulatedAmplifier>> amplifiers;
  WorldLines lines;
  bool supply_fails = false;  // of the drives with a supply model, whatever the relay does

 private:
  static constexpr std::int64_t kSliceNs = 1'000'000;
  struct Node {
    CanopenNodeConfig config;
    std::unique_ptr<MemoryBus> bus;
    std::unique_ptr<SimulatedNode> node;
  };

  void AddNode(const CanopenNodeConfig& config) {
    auto bus = std::make_unique<MemoryBus>(&wire, "vcan0");
    SimulatedNodeConfig simulated = SimulatedNodeOf(config);
    if (IsDrive(config.role)) simulated.supply = supply_;
    auto node = std::make_unique<SimulatedNode>(bus.get(), simulated);
    node->Start();
    wire.AddRunner([node = node.get()] { node->Run(); });
    nodes_.push_back({.config = config, .bus = std::move(bus), .node = std::move(node)});
  }

  void Show(std::int64_t now_ns) noexcept {
    const SensorFrame frame = rig_.Sample(now_ns);
    for (Node& node : nodes_) {
      const int counter = node.config.counter();
      if (counter >= 0) node.node->SetPosition(frame.counter[static_cast<std::size_t>(counter)]);
    }
    for (const auto& amplifier : amplifiers) amplifier->Show(frame);
    shown_.push_back({.from_ns = now_ns, .frame = frame});
    if (shown_.size() > 500) shown_.pop_front();
  }

  // A task that is due at the same instant runs first, and reads the values before it.
  bool WasThere(std::int64_t instant_ns,
                const std::function<bool(const SensorFrame&)>& found) const {
    return std::any_of(shown_.begin(), shown_.end(), [&](const Shown& shown) {
      const std::int64_t age_ns = instant_ns - shown.from_ns;
      return age_ns >= 0 && age_ns <= 2 * kSliceNs && found(shown.frame);
    });
  }

  BlockingExecutor* executor_;
  SimulatedRig rig_;
  std::optional<DriveSupplyModel> supply_;
  std::vector<Node> nodes_;
  std::deque<Shown> shown_;
};

/// A real driver on the simulated clock: each call takes as long as its peer needs, or as long as
/// the test sets.
class OnTestTime final : public BusDevice {
 public:
  /// Instant at which a call returns, from its start and its status.
  using Returns = std::function<std::int64_t(std::int64_t call_ns, BusStatus status)>;

  /// @param worst_ns  what the rig's device declares
  OnTestTime(BusDevice* driver, BlockingExecutor* executor, WiredWorld* world,
             std::int64_t worst_ns, Returns returns)
      : driver_(driver),
        executor_(executor),
        world_(world),
        worst_ns_(worst_ns),
        returns_(std::move(returns)) {}

  const char* name() const noexcept override { return driver_->name(); }
  std::uint32_t drives() const noexcept override { return driver_->drives(); }
  std::uint32_t drives_on() const noexcept override { return driver_->drives_on(); }
  std::int64_t worst_case_ns() const noexcept override { return worst_ns_; }
  DriveVoltage voltage() const noexcept override { return driver_->voltage(); }
  CountEpochs count_epochs() const noexcept override { return driver_->count_epochs(); }
  bool needs_reconnect() const noexcept override { return driver_->needs_reconnect(); }
  BusFault notice() const noexcept override { return driver_->notice(); }
  std::span<const char* const> counter_names() const noexcept override {
    return driver_->counter_names();
  }
  BusCounters counter_values() const noexcept override { return driver_->counter_values(); }
  void Open() override { driver_->Open(); }
  BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override {
    world_->wire.AdvanceTo(world_->monotonic_ns());
    return Wait(driver_->Exchange(command, part));
  }
  BusStatus SwitchOff() noexcept override {
    world_->wire.AdvanceTo(world_->monotonic_ns());
    return driver_->SwitchOff();
  }
  BusStatus Reconnect() noexcept override {
    world_->wire.AdvanceTo(world_->monotonic_ns());
    reconnects_under_power += world_->lines.relay ? 1 : 0;
    return Wait(driver_->Reconnect());
  }
  BusFault FaultOf(BusStatus status) const noexcept override { return driver_->FaultOf(status); }
  std::string FaultText(const BusFault& fault) const override { return driver_->FaultText(fault); }
  void Close() noexcept override { driver_->Close(); }

  int reconnects_under_power = 0;

 private:
  BusStatus Wait(BusStatus status) {
    executor_->BlockUntil(returns_(executor_->now_ns(), status));
    return status;
  }

  BusDevice* driver_;
  BlockingExecutor* executor_;
  WiredWorld* world_;
  std::int64_t worst_ns_;
  Returns returns_;
};

}  // namespace flexarm
