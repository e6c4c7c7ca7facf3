#pragma once

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "controller/commissioning/commissioner.h"
#include "controller/design/run_design.h"
#include "controller/runlog/safety_rows.h"
#include "controller/tasks/wired_stack.h"
#include "hal/modbus/modbus_device.h"
#include "hal/modbus/modbus_plan.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/controller/wired/wired_world.h"
#include "tests/support/loop_time.h"

namespace flexarm {

inline constexpr std::int64_t kHalfMs = 500'000;
// Time-out of the real sockets where no reply comes: longer than the reply time of a loaded
// machine.
inline constexpr double kResponseTimeout_ms = 100.0;

// CLOCK_MONOTONIC of the amplifiers' drivers.
inline const WiredWorld* the_world = nullptr;
inline std::int64_t Clock() noexcept { return the_world->monotonic_ns(); }

inline RigConfig WiredConfig(ModbusTransport transport,
                             const std::optional<DriveVoltageTimes>& voltage) {
  RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil-wire.toml", {});
  config.hal.gpiod->drive_voltage = voltage;
  config.daemon.log_directory =
      testing::TempDir() + "/flexarm-wired-" + std::to_string(getpid()) + "-calibration";
  std::filesystem::remove_all(config.daemon.log_directory);
  std::filesystem::create_directories(config.daemon.log_directory);
  std::vector<ModbusDeviceConfig> devices = ConfigsOf<ModbusWiring>(config.hal);
  for (ModbusDeviceConfig& device : devices) {
    device.port = 0;
    device.response_timeout_ms = kResponseTimeout_ms;
  }
  ModbusDeviceConfig& hostile = devices[0];
  hostile.transport = transport;
  hostile.device = testing::TempDir() + "/flexarm-hostile-bus-" + std::to_string(getpid());
  hostile.baud = 115200;
  hostile.parity = ModbusParity::kEven;
  hostile.data_bits = 8;
  hostile.stop_bits = 1;
  std::erase_if(config.hal.bus, [](const HalConfig::Bus& bus) {
    return dynamic_cast<const ModbusWiring*>(bus.wiring.get()) != nullptr;
  });
  for (ModbusDeviceConfig& device : devices) {
    config.hal.Add(std::make_shared<ModbusWiring>(std::move(device)));
  }
  return config;
}

/// The rig with its drivers and the daemon's tasks.
class Rig {
 public:
  /// @param supply  of the drives; none: they are always supplied
  /// @param voltage  as a witness of the power path; none: it is no witness
  explicit Rig(ModbusTransport transport,
               const std::optional<DriveSupplyModel>& supply = std::nullopt,
               const std::optional<DriveVoltageTimes>& voltage = std::nullopt)
      : config_(WiredConfig(transport, voltage)) {
    const sched_param parameters{.sched_priority = 10};  // where permitted: before ordinary threads
    sched_setscheduler(0, SCHED_FIFO, &parameters);
    world = std::make_unique<WiredWorld>(config_, &executor, supply);
    the_world = world.get();
    AddCan();
    for (std::size_t i = 0; i < world->amplifiers.size(); ++i) AddAmplifier(i);
    RigWires wires{.buses = {}, .lines = &world->lines};
    for (const auto& bus : buses) {
      bus->Open();
      wires.buses.push_back(bus.get());
    }
    world->epoch_ns = world->wire.now_ns() + 100 * kMs;  // opening them took time
    stack = std::make_unique<WiredStack>(config_, design_, wires);
    stack->SetEpoch(world->epoch_ns);
    planned_ = std::make_unique<PlannedExperiment>(
        experiment_, design_, 0.02, std::array<double, 2>{0.0, 0.0}, MotionLimitsOf(config_));
    executor.Add(stack->safety());
    executor.Add(stack->control());
    for (Task* task : stack->drive_tasks()) executor.Add(*task, true);
    executor.Add(*world);
  }
  ~Rig() {
    executor.Stop();
    the_world = nullptr;
  }

  void RunFor(std::int64_t duration_ns) {
    const std::int64_t end_ns = executor.now_ns() + duration_ns;
    for (std::int64_t t = executor.now_ns(); t < end_ns; t += kMs) {
      executor.RunUntil(std::min(t + kMs, end_ns));
      commissioner.Follow(stack->count_epochs());
      while (stack->tick_records().Pop(&last)) {
        Look(last);
        commissioner.Take(last);
      }
      stack->Calibrate(commissioner.calibration());
    }
  }

  bool RunUntil(std::int64_t at_most_ns, const std::function<bool()>& there) {
    const std::int64_t end_ns = executor.now_ns() + at_most_ns;
    while (!there() && executor.now_ns() < end_ns) RunFor(kMs);
    return there();
  }

  Refusal Ask(RequestKind kind) {
    stack->requests().Push({.kind = kind,
                            .number = ++number_,
                            .not_before_ns = INT64_MIN,
                            .run = {.experiment = planned_.get()}});
    RequestAnswer answer{};
    // A run waits until the drives are on: three transitions of CiA 402, one a period. A reset
    // waits until they have left their faults.
    const std::int64_t longest_ns = kind == RequestKind::kReset ? 2050 * kMs : 1550 * kMs;
    bool answered = false;
    EXPECT_TRUE(RunUntil(longest_ns, [&] {
      while (!answered && stack->answers().Pop(&answer)) answered = answer.number == number_;
      return answered;
    }));
    present = answer.present;
    return answer.refusal;
  }

  void Disarm() {
    stack->disarm().Set(++number_);
    EXPECT_TRUE(RunUntil(200 * kMs, [this] { return permit().state == SafetyState::kIdle; }));
  }
  void Stop() {
    stack->stop().Set(++number_);
    EXPECT_TRUE(RunUntil(4000 * kMs, [this] { return permit().state == SafetyState::kArmed; }));
  }
  void PressButton() {
    world->lines.levels |= LineBit(Line::kResetButton);
    RunFor(60 * kMs);  // 50 ms count as a press
    world->lines.levels = kHealthyLevels;
    RunFor(20 * kMs);
  }

  Permit permit() { return stack->operator_permits().Read().Newest().value; }
  bool tripped() { return permit().state == SafetyState::kTripped; }
  std::string Named() { return stack->BusText(permit().cause, permit().evidence); }
  std::uint32_t Failed() {
    std::uint32_t failed = 0;
    for (const BusHealth& bus : stack->buses()) failed += bus.failed;
    return failed;
  }
  bool AllBack() {
    const std::vector<BusHealth> health = stack->buses();
    return std::all_of(health.begin(), health.end(), [](const BusHealth& bus) { return bus.ok; });
  }

  BlockingExecutor executor;
  std::unique_ptr<WiredWorld> world;
  std::vector<std::unique_ptr<OnTestTime>> buses;  // CAN, then the amplifiers
  std::unique_ptr<WiredStack> stack;
  MemoryBus* master = nullptr;
  std::int64_t hangs_ns = 0;  // an exchange with the first amplifier takes this long, if not 0
  std::int64_t ticks = 0;
  TickRecord last{};
  bool looks_at_counters = true;
  TripCauses present = 0;  // at the last request
  int stale = 0;           // readings that were not present at their stated instant

 private:
  void AddCan() {
    auto bus = std::make_unique<MemoryBus>(&world->wire, "vcan0");
    master = bus.get();
    drivers_.push_back(
        std::make_unique<CanopenDevice>(ConfigsOf<CanopenWiring>(config_.hal)[0], std::move(bus)));
    // The driver waits on the bus, whose time is ahead of the others' during a call.
    WiredWorld* there = world.get();
    buses.push_back(std::make_unique<OnTestTime>(
        drivers_.back().get(), &executor, there, drivers_.back()->worst_case_ns(),
        [there](std::int64_t call_ns, BusStatus) {
          return std::max(call_ns, there->wire.now_ns() - there->epoch_ns);
        }));
  }

  void AddAmplifier(std::size_t i) {
    ModbusDeviceConfig config = ConfigsOf<ModbusWiring>(config_.hal)[i];
    config.port = world->amplifiers[i]->server().port();
    drivers_.push_back(std::make_unique<ModbusDevice>(config, Clock));
    // The shipped time-out, not the long one of this test.
    config.response_timeout_ms = 4.0;
    const ModbusPlan plan = PlanModbus(config);
    const std::int64_t worst_ns = std::max(plan.exchange_worst_ns, plan.reconnect_worst_ns);
    buses.push_back(std::make_unique<OnTestTime>(
        drivers_.back().get(), &executor, world.get(), worst_ns,
        [this, i, worst_ns](std::int64_t call_ns, BusStatus status) {
          if (i == 0 && hangs_ns > 0) return call_ns + hangs_ns;
          return call_ns + (status == BusStatus::kOk ? kHalfMs : worst_ns);
        }));
  }

  // Checks a reading against the values that the simulated rig had, which only the test has.
  void Look(const TickRecord& record) {
    const StepInput& in = record.input;
    ++ticks;
    for (std::size_t i = 0; i < kMaxStrainChannels; ++i) {
      if ((in.frame.strain_valid >> i & 1u) == 0) continue;
      const std::int64_t at_ns = in.frame.sampled_at_ns + in.frame.strain_offset_ns[i];
      stale += world->Showed(i, in.frame.strain[i], at_ns) ? 0 : 1;
    }
    for (std::size_t i = 0; i < kCounters && looks_at_counters; ++i) {
      if ((in.frame.counter_valid >> i & 1u) == 0) continue;
      const std::int64_t at_ns = in.frame.sampled_at_ns + in.frame.counter_offset_ns[i];
      stale += world->CounterWas(i, in.frame.counter[i], at_ns) ? 0 : 1;
    }
  }

  const RigConfig config_;
  const Experiment experiment_ = ShippedExperiment();
  const Design design_ = DesignFor(config_);
  std::vector<std::unique_ptr<BusDevice>> drivers_;
  std::unique_ptr<PlannedExperiment> planned_;
  std::uint32_t number_ = 0;

 public:
  Commissioner commissioner{config_};
};

class HostileBus : public testing::Test {
 protected:
  // At rest.
  void StartIdle(ModbusTransport transport = ModbusTransport::kTcp,
                 const std::optional<DriveSupplyModel>& supply = std::nullopt,
                 const std::optional<DriveVoltageTimes>& voltage = std::nullopt) {
    rig_ = std::make_unique<Rig>(transport, supply, voltage);
    ASSERT_TRUE(rig_->RunUntil(2000 * kMs, [this] {
      return rig_->permit().state == SafetyState::kIdle;
    })) << ToString(rig_->permit().cause);
    rig_->RunFor(600 * kMs);
  }

  // In mid-run, between two moves: an arm without torque must not drift out of its limits before it
  // can be armed again.
  void StartRun(ModbusTransport transport = ModbusTransport::kTcp,
                const std::optional<DriveSupplyModel>& supply = std::nullopt) {
    ASSERT_NO_FATAL_FAILURE(StartIdle(transport, supply));
    ASSERT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
    ASSERT_EQ(rig_->Ask(RequestKind::kRun), Refusal::kNone);
    rig_->RunFor(2000 * kMs);
    ASSERT_EQ(rig_->permit().state, SafetyState::kRunning) << ToString(rig_->permit().cause);
    ASSERT_TRUE(rig_->RunUntil(500 * kMs, [this] { return rig_->world->drives_make_torque(); }));
    failed_before_ = rig_->Failed();
    EXPECT_EQ(failed_before_, 0U);
  }

  SimulatedAmplifier& amplifier() { return *rig_->world->amplifiers[0]; }

  void Behave(WireFault fault, std::chrono::milliseconds late = {}) {
    amplifier().server().Behave(fault, late);
    WiredWorld::Settle(&amplifier());
  }

  // A bus trips, or what it no longer reads does; trip or bus name the device; the torque ends.
  void ExpectNamed(const std::string& name) {
    ASSERT_TRUE(rig_->RunUntil(500 * kMs, [this] { return rig_->tripped(); }));
    EXPECT_TRUE(rig_->permit().cause == TripCause::kBusLost ||
                rig_->permit().cause == TripCause::kDriveFault ||
                rig_->permit().cause == TripCause::kStaleFrame ||
                rig_->permit().cause == TripCause::kNoStrainReading1)
        << ToString(rig_->permit().cause);
    rig_->RunFor(40 * kMs);  // the exchange ends, and the bus is lost as well
    const std::string said = rig_->Named() + Lost();
    EXPECT_NE(said.find(name), std::string::npos) << said;
    EXPECT_GT(rig_->Failed() + (rig_->hangs_ns > 0 ? 1 : 0), failed_before_);
    EXPECT_FALSE(rig_->world->lines.relay);
    rig_->RunFor(121 * kMs);  // the drives' own time-out of 100 ms, and a period
    EXPECT_FALSE(rig_->world->drives_make_torque());
  }

  // After the repair the bus comes back while disarmed, and the arm can be armed.
  void ExpectArmable(const std::function<void()>& mend) {
    mend();
    EXPECT_TRUE(rig_->RunUntil(6000 * kMs, [this] { return rig_->AllBack(); })) << Lost();
    EXPECT_TRUE(rig_->tripped()) << "only the bus comes back by itself";
    rig_->PressButton();
    ExpectReset();
    EXPECT_EQ(rig_->Ask(RequestKind::kArm), Refusal::kNone);
    rig_->RunFor(200 * kMs);
    EXPECT_EQ(rig_->permit().state, SafetyState::kArmed) << ToString(rig_->permit().cause);
  }

  // The button has been pressed.
  void ExpectReset() {
    Refusal refusal = Refusal::kNotAtRest;
    for (int k = 0; k < 100 && refusal != Refusal::kNone; ++k) {
      rig_->RunFor(50 * kMs);  // the arm comes to rest, and the loop gets healthy reports
      refusal = rig_->Ask(RequestKind::kReset);
    }
    EXPECT_EQ(refusal, Refusal::kNone) << CauseNames(rig_->present);
  }

  std::string Lost() {
    std::string text;
    for (const BusHealth& bus : rig_->stack->buses()) {
      if (!bus.ok) text += bus.fault + "; ";
    }
    return text;
  }

  void TearDown() override {
    if (!rig_) return;
    const BlockingExecutor& executor = rig_->executor;
    const auto control = executor.statistics(rig_->stack->control());
    const auto safety = executor.statistics(rig_->stack->safety());
    EXPECT_EQ(control.late + control.missed + control.skipped, 0);
    EXPECT_EQ(safety.late + safety.missed + safety.skipped, 0);
    EXPECT_EQ(control.activations, (executor.now_ns() - 10 * kMs + 20 * kMs - 1) / (20 * kMs));
    EXPECT_EQ(rig_->ticks, control.activations) << "each wrote its record";
    EXPECT_EQ(rig_->stale, 0);
    for (const auto& bus : rig_->buses) EXPECT_EQ(bus->reconnects_under_power, 0);
  }

  std::unique_ptr<Rig> rig_;
  std::uint32_t failed_before_ = 0;
};

}  // namespace flexarm
