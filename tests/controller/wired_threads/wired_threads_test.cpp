// The wired stack with its real threads: drivers, safety, control, an operator. The CAN bus is in
// memory, the amplifiers behind real sockets, buses fail and come back. Asserted: every request is
// answered once, every thread ends, lost buses are connected again. Never asserted: when.

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <vector>

#include "config/config.h"
#include "controller/design/run_design.h"
#include "controller/operator/request_tracker.h"
#include "controller/realtime/clock.h"
#include "controller/realtime/realtime_executor.h"
#include "controller/tasks/wired_stack.h"
#include "hal/canopen/canopen_device.h"
#include "hal/canopen/canopen_wiring.h"
#include "hal/emulation/memory_bus.h"
#include "hal/emulation/simulated_amplifier.h"
#include "hal/emulation/simulated_node.h"
#include "hal/modbus/modbus_device.h"
#include "hal/modbus/modbus_wiring.h"
#include "hal/sim/simulated_rig.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/support/campaign.h"
#include "tests/support/fifo_permitted.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr std::int64_t kPatienceNs = 60'000 * kMs;  // a loaded machine, a slow sanitizer

// CLOCK_MONOTONIC of the drivers: from a small number on, since the bus in memory counts from 0.
std::atomic<std::int64_t> clock_zero_ns{0};
std::int64_t DriverClock() noexcept { return MonotonicNow() - clock_zero_ns.load(); }

/// The safety chain; its switches are operated by the test's thread.
class AtomicLines final : public SafetyLines {
 public:
  Reading Read(std::int64_t) noexcept override { return {.levels = levels.load()}; }
  Call Write(std::int64_t, const Outputs& outputs) noexcept override {
    relay.store(outputs.relay_closed);
    return {};
  }
  void HoldOff() noexcept override { relay.store(false); }

  std::atomic<LineLevels> levels{kHealthyLevels};
  std::atomic<bool> relay{false};
};

/// The simulated arm with its CAN nodes, every millisecond. The wire has its own time and belongs
/// to one thread at a time: it is locked, as a kernel locks a real one.
class ArmOnAWire final : public Task {
 public:
  ArmOnAWire(const RigConfig& config, const std::vector<std::unique_ptr<SimulatedAmplifier>>* shown)
      : shown_(shown), rig_(config.arm, config.sensors, config.sim) {
    const CanopenConfig can = ConfigsOf<CanopenWiring>(config.hal).at(0);
    for (const CanopenNodeConfig& node : can.node) {
      auto bus = std::make_unique<MemoryBus>(&wire, "vcan0");
      auto simulated = std::make_unique<SimulatedNode>(bus.get(), SimulatedNodeOf(node));
      simulated->Start();
      wire.AddRunner([running = simulated.get()] { running->Run(); });
      nodes.push_back({node, std::move(bus), std::move(simulated)});
    }
  }

  Traits traits() const noexcept override {
    return {.name = "world", .period_ns = kMs, .phase_ns = 0, .deadline_ns = kMs, .priority = 60};
  }

  void Run(const Activation& activation) noexcept override {
    SensorFrame frame{};
    {
      const std::lock_guard lock(mutex);
      wire.AdvanceTo(DriverClock());
      std::array<double, 2> torque_nm{};
      for (const Node& node : nodes) {
        if (!IsDrive(node.config.role)) continue;
        torque_nm[static_cast<std::size_t>(node.config.role)] =
            node.config.sign * node.node->torque_per_mille() * node.config.torque_per_mille_nm;
      }
      rig_.SetTorque(torque_nm);
      for (std::int64_t t = 0; t < kMs; t += rig_.step_ns()) rig_.Step();
      frame = rig_.Sample(activation.due_ns);
      for (const Node& node : nodes) {
        const int counter = node.config.counter();
        if (counter >= 0) node.node->SetPosition(frame.counter[static_cast<std::size_t>(counter)]);
      }
    }
    for (const auto& amplifier : *shown_) amplifier->Show(frame);
  }

  struct Node {
    CanopenNodeConfig config;
    std::unique_ptr<MemoryBus> bus;
    std::unique_ptr<SimulatedNode> node;
  };

  std::mutex mutex;  // of the wire and the nodes
  MemoryWire wire{1'000'000};
  std::vector<Node> nodes;

 private:
  const std::vector<std::unique_ptr<SimulatedAmplifier>>* shown_;
  SimulatedRig rig_;
};

/// The driver of the bus in memory, on real time: a call lasts as long as the wire says.
class CanOnRealTime final : public BusDevice {
 public:
  CanOnRealTime(const CanopenConfig& config, ArmOnAWire* world) : world_(world) {
    driver_ =
        std::make_unique<CanopenDevice>(config, std::make_unique<MemoryBus>(&world->wire, "vcan0"));
  }

  const char* name() const noexcept override { return driver_->name(); }
  std::uint32_t drives() const noexcept override { return driver_->drives(); }
  std::uint32_t drives_on() const noexcept override { return driver_->drives_on(); }
  std::int64_t worst_case_ns() const noexcept override { return driver_->worst_case_ns(); }
  CountEpochs count_epochs() const noexcept override { return driver_->count_epochs(); }
  bool needs_reconnect() const noexcept override { return driver_->needs_reconnect(); }
  BusFault notice() const noexcept override { return driver_->notice(); }
  void Open() override { driver_->Open(); }
  BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override {
    return OnTheWire([&] { return driver_->Exchange(command, part); });
  }
  BusStatus SwitchOff() noexcept override {
    return OnTheWire([&] { return driver_->SwitchOff(); });
  }
  BusStatus Reconnect() noexcept override {
    ++reconnects;
    return OnTheWire([&] { return driver_->Reconnect(); });
  }
  BusFault FaultOf(BusStatus status) const noexcept override { return driver_->FaultOf(status); }
  std::string FaultText(const BusFault& fault) const override { return driver_->FaultText(fault); }
  void Close() noexcept override { driver_->Close(); }

  std::atomic<int> reconnects{0};

 private:
  template <typename Call>
  BusStatus OnTheWire(Call call) noexcept {
    BusStatus status{};
    std::int64_t ends_ns = 0;
    {
      const std::lock_guard lock(world_->mutex);
      world_->wire.AdvanceTo(DriverClock());
      status = call();
      ends_ns = world_->wire.now_ns();
    }
    SleepUntil(ends_ns + clock_zero_ns.load());
    return status;
  }

  ArmOnAWire* world_;
  std::unique_ptr<CanopenDevice> driver_;
};

/// A rig from start to end, operated by the test's thread.
class Cycle {
 public:
  Cycle(const RigConfig& config, const Design& design, PlannedExperiment* experiment, unsigned seed)
      : experiment_(experiment), random_(seed) {
    clock_zero_ns.store(MonotonicNow());
    for (ModbusDeviceConfig device : ConfigsOf<ModbusWiring>(config.hal)) {
      device.port = 0;
      amplifiers_.push_back(std::make_unique<SimulatedAmplifier>(device, config.sensors));
      device.port = amplifiers_.back()->server().port();
      devices_.push_back(std::make_unique<ModbusDevice>(device, DriverClock));
    }
    world_ = std::make_unique<ArmOnAWire>(config, &amplifiers_);
    auto can =
        std::make_unique<CanOnRealTime>(ConfigsOf<CanopenWiring>(config.hal).at(0), world_.get());
    can_ = can.get();
    devices_.push_back(std::move(can));
    RigWires wires{.buses = {}, .lines = &lines_};
    for (const auto& device : devices_) {
      device->Open();
      wires.buses.push_back(device.get());
    }
    clock_zero_ns.store(MonotonicNow() - world_->wire.now_ns());  // opening took the wire's time
    stack_ = std::make_unique<WiredStack>(config, design, wires);
    latch_.Open();
    tracker_ = std::make_unique<RequestTracker>(stack_.get(), &latch_);
    for (Task* task : stack_->tasks()) executor_.Add(*task);
    executor_.Add(*world_);
    const std::int64_t epoch_ns = MonotonicNow() + 20 * kMs;
    epoch_ns_ = epoch_ns;
    stack_->SetEpoch(epoch_ns - clock_zero_ns.load());
    executor_.Start(epoch_ns);
  }
  ~Cycle() {
    executor_.RequestStop();
    executor_.Join();
    for (const auto& device : devices_) device->Close();
  }
  Cycle(const Cycle&) = delete;
  Cycle& operator=(const Cycle&) = delete;

  /// Random requests, switches and failing buses, then an orderly end.
  void Live(int acts) {
    for (int i = 0; i < acts; ++i) {
      Act();
      Rest(static_cast<std::int64_t>(random_() % 20) * kMs);
    }
    Mend();
    AwaitAnswers();
    stack_->RequestShutdown();
    const std::int64_t end_ns = MonotonicNow() + kPatienceNs;
    while (lines_.relay.load() && MonotonicNow() < end_ns) Rest(kMs);
    EXPECT_FALSE(lines_.relay.load()) << "a shutdown opens the relay";
  }

  /// A bus that fails while disarmed is connected again, and its readings come back.
  void LoseAndConnectAgain() {
    Fail();
    Await("a lost bus is tried again", [this] { return can_->reconnects.load() > 0; });
    Mend();
    Await("all buses are back", [this] {
      for (const BusHealth& bus : stack_->buses()) {
        if (!bus.ok) return false;
      }
      return true;
    });
  }

  /// Arms and runs, if the machine is fast enough for that.
  /// @returns whether the experiment runs
  bool TryToRun() {
    const std::int64_t end_ns = MonotonicNow() + 3'000 * kMs;
    while (state() != SafetyState::kArmed && MonotonicNow() < end_ns) {
      Ask(RequestKind::kArm);
      Rest(50 * kMs);
    }
    Ask(RequestKind::kRun);
    AwaitAnswers();
    Rest(100 * kMs);
    return state() == SafetyState::kRunning;
  }

  int answered() const { return answered_; }
  int reconnects() const { return can_->reconnects.load(); }

 private:
  void Act() {
    switch (random_() % 10) {
      case 0:
        return Ask(RequestKind::kArm);
      case 1:
        return Ask(RequestKind::kRun);
      case 2:
        return Ask(RequestKind::kStop);
      case 3:
        return Ask(RequestKind::kDisarm);
      case 4:
        return Ask(RequestKind::kReset);
      case 5:
        return lines_.levels.store(kHealthyLevels ^ (LineLevels{1} << random_() % kLines));
      case 6:
        return Fail();
      case 7:
        amplifiers_[random_() % amplifiers_.size()]->server().Behave(WireFault::kSilent);
        return;
      default:
        return Mend();
    }
  }

  void Ask(RequestKind kind) {
    const int client = ++asked_;
    const RunOrder run{.experiment = kind == RequestKind::kRun ? experiment_ : nullptr};
    const std::int64_t now_ns = MonotonicNow() - epoch_ns_;
    if (tracker_->Ask(kind, now_ns, client, run).number != 0) open_[client] = kind;
  }

  // Every node of the CAN bus without power.
  void Fail() { PowerNodes(false); }
  void Mend() {
    lines_.levels.store(kHealthyLevels);
    for (const auto& amplifier : amplifiers_) amplifier->server().Behave(WireFault::kNone);
    PowerNodes(true);
  }
  void PowerNodes(bool on) {
    const std::lock_guard lock(world_->mutex);
    for (const ArmOnAWire::Node& node : world_->nodes) node.node->Misbehave({.silent = !on});
  }

  // The operator's part of the stack, at least once and for a time.
  void Rest(std::int64_t duration_ns) {
    const std::int64_t end_ns = MonotonicNow() + duration_ns;
    do {
      TickRecord tick{};
      while (stack_->operator_ticks().Pop(&tick)) continue;
      while (stack_->tick_records().Pop(&tick)) continue;
      SafetyRecord safety{};
      while (stack_->safety_records().Pop(&safety)) continue;
      const Permit& permit = stack_->operator_permits().Read().Newest().value;
      state_ = permit.state;
      latch_.Follow(MonotonicNow() - epoch_ns_, permit, tracker_->busy());
      RequestAnswer answer{};
      while (stack_->answers().Pop(&answer)) {
        for (const int client : tracker_->TakeClientsOf(answer)) {
          EXPECT_EQ(open_.erase(client), 1U) << "answered twice, or never asked: " << client;
          ++answered_;
        }
      }
      SleepUntil(std::min(end_ns, MonotonicNow() + kMs));
    } while (MonotonicNow() < end_ns);
  }

  SafetyState state() const { return state_; }

  template <typename There>
  void Await(const char* what, There there) {
    const std::int64_t end_ns = MonotonicNow() + kPatienceNs;
    while (!there() && MonotonicNow() < end_ns) Rest(kMs);
    EXPECT_TRUE(there()) << what;
  }
  void AwaitAnswers() {
    Await("every request is answered", [this] { return open_.empty(); });
  }

  PlannedExperiment* experiment_;
  std::mt19937 random_;
  AtomicLines lines_;
  std::vector<std::unique_ptr<SimulatedAmplifier>> amplifiers_;
  std::unique_ptr<ArmOnAWire> world_;
  std::vector<std::unique_ptr<BusDevice>> devices_;
  CanOnRealTime* can_ = nullptr;
  std::unique_ptr<WiredStack> stack_;
  LatchFolder folder_;
  TripLatch latch_{folder_.path(), "/runs", [](bool, const std::string&) {}};
  std::unique_ptr<RequestTracker> tracker_;
  RealtimeExecutor executor_{FifoPermitted(SafetyTask::kPriority)};
  std::int64_t epoch_ns_ = 0;
  SafetyState state_ = SafetyState::kStarting;
  int asked_ = 0, answered_ = 0;
  std::map<int, RequestKind> open_;  // by client: each request has its own
};

// The sample also under a sanitizer, which is what the test is for.
long Cycles() {
  const long wanted = CampaignCases(0, 1'000);
  return wanted > 0 ? wanted : 30;
}

TEST(WiredThreads, CampaignEveryRequestIsAnsweredAndEveryThreadEnds) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil-wire.toml");
  const Design design = DesignFor(config);
  PlannedExperiment experiment(ShippedExperiment(), design, 0.02, {0.0, 0.0},
                               MotionLimitsOf(config));
  int answered = 0, reconnects = 0, runs = 0;
  for (int seed = 1; seed <= Cycles(); ++seed) {
    SCOPED_TRACE(seed);
    Cycle cycle(config, design, &experiment, static_cast<unsigned>(seed));
    if (seed % 10 == 1) cycle.LoseAndConnectAgain();
    if (seed % 3 == 0 && cycle.TryToRun()) ++runs;
    cycle.Live(12);
    answered += cycle.answered();
    reconnects += cycle.reconnects();
  }
  EXPECT_GT(answered, 0);
  EXPECT_GT(reconnects, 0);
  RecordProperty("runs", runs);  // none on a machine that is too slow
}

}  // namespace
}  // namespace flexarm
