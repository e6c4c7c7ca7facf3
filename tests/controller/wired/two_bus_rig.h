#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/operator/unattended_run.h"
#include "controller/realtime/lockstep_executor.h"
#include "controller/tasks/wired_stack.h"
#include "hal/sim/simulated_rig.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/support/loop_time.h"

// The wired stack in lock step: two simple buses around the simulated arm.

namespace flexarm {

/// The arm behind two buses: encoders and drives on one, gauges on the other.
struct World {
  explicit World(const RigConfig& config) : rig(config.arm, config.sensors, config.sim) {}

  void AdvanceTo(std::int64_t instant_ns) {
    for (; now_ns < instant_ns; now_ns += rig.step_ns()) rig.Step();
  }

  SimulatedRig rig;
  std::int64_t now_ns = 0;
  SensorFrame frame{};
};

class DriveBus final : public BusDevice {
 public:
  explicit DriveBus(World* world) : world_(world) {}

  const char* name() const noexcept override { return "drives"; }
  std::uint32_t drives() const noexcept override { return 0b11; }
  std::uint32_t drives_on() const noexcept override { return last.enabled && confirms ? 0b11 : 0; }
  std::int64_t worst_case_ns() const noexcept override { return 6 * kMs; }
  void Open() override {}
  BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override {
    ++exchanges;
    last = command;
    world_->AdvanceTo(exchanges * 20 * kMs);
    world_->rig.SetTorque(command.enabled ? command.torque_nm : std::array<double, 2>{});
    world_->frame = world_->rig.Sample(world_->now_ns);
    *part = world_->frame;
    part->strain_valid = 0;
    const bool fail =
        (exchanges >= fail_from && exchanges < fail_until) || (fails && fails(exchanges));
    return fail ? failure : BusStatus::kOk;
  }
  BusStatus Reconnect() noexcept override {
    ++reconnects;
    ++exchanges;
    world_->AdvanceTo(exchanges * 20 * kMs);
    return exchanges < fail_until ? failure : BusStatus::kOk;
  }
  void Close() noexcept override {}

  std::int64_t exchanges = -1;  // the first is at instant 0
  int reconnects = 0;
  bool confirms = true;  // that the drives are on
  std::int64_t fail_from = INT64_MAX, fail_until = INT64_MAX;
  std::function<bool(std::int64_t exchange)> fails;  // empty: none does
  BusStatus failure = BusStatus::kTimeout;
  BusCommand last{};

 private:
  World* world_;
};

class GaugeBus final : public BusDevice {
 public:
  explicit GaugeBus(World* world) : world_(world) {}

  const char* name() const noexcept override { return "gauges"; }
  std::int64_t worst_case_ns() const noexcept override { return 6 * kMs; }
  void Open() override {}
  BusStatus Exchange(const BusCommand&, SensorFrame* part) noexcept override {
    *part = world_->frame;
    part->counter_valid = 0;
    part->strain_valid &= ~lost;
    part->levels = levels;
    return fails && fails(exchanges++) ? BusStatus::kTimeout : status;
  }
  LineLevels lines() const noexcept override { return own_lines; }
  BusStatus Reconnect() noexcept override { return status; }
  void Close() noexcept override {}

  BusStatus status = BusStatus::kOk;
  std::function<bool(std::int64_t exchange)> fails;  // numbered from 0; empty: none does
  std::uint32_t lost = 0;  // bit i: gauge i answers without a good reading
  LineLevels own_lines = LineBit(Line::kLimit2High) | LineBit(Line::kResetButton);
  LineLevels levels = LineBit(Line::kLimit2High);
  std::int64_t exchanges = 0;

 private:
  World* world_;
};

class ClosedLines final : public SafetyLines {
 public:
  Reading Read(std::int64_t) noexcept override { return {.levels = levels}; }
  Call Write(std::int64_t, const Outputs& outputs) noexcept override {
    relay = outputs.relay_closed;
    return {};
  }
  void HoldOff() noexcept override { relay = false; }

  LineLevels levels = kHealthyLevels;
  bool relay = false;
};

/// A task whose executor says what the test wants of an activation. It runs at its due instant.
class HostedTask final : public Task {
 public:
  struct Host {
    int missed_in_a_row = 0;
    std::int64_t previous_run_ns = 0;
    bool skips = false;  // this activation
  };

  explicit HostedTask(Task* task) : task_(task) {}
  Traits traits() const noexcept override { return task_->traits(); }
  void Run(const Activation& activation) noexcept override {
    const Host host = says ? says(number++) : Host{};
    if (host.skips) return;
    task_->Run({.due_ns = activation.due_ns,
                .missed_in_a_row = host.missed_in_a_row,
                .late_ns = 0,
                .previous_run_ns = host.previous_run_ns});
  }
  Wakeup* wakeup() noexcept override { return task_->wakeup(); }
  void Woken(std::int64_t now_ns) noexcept override { task_->Woken(now_ns); }

  std::function<Host(std::int64_t number)> says;  // numbered from 0; empty: all is well
  std::int64_t number = 0;

 private:
  Task* task_;
};

class WiredStackTest : public testing::Test {
 protected:
  WiredStackTest() {
    for (Task* task : stack_.tasks()) executor_.Add(threads_.emplace_back(task));
  }

  HostedTask& Thread(const std::string& name) {
    const auto found = std::find_if(threads_.begin(), threads_.end(), [&](const HostedTask& task) {
      return name == task.traits().name;
    });
    EXPECT_NE(found, threads_.end()) << name;
    return *found;
  }

  void RunUntil(std::int64_t end_ns) {
    for (; now_ns_ < end_ns; now_ns_ += 20 * kMs) {
      executor_.RunUntil(now_ns_ + 20 * kMs);
      TickRecord record{};
      while (stack_.tick_records().Pop(&record)) ticks_.push_back(record);
      const OperatorRequest request = operator_.Update(now_ns_, permit());
      if (request.kind != RequestKind::kNone) stack_.requests().Push(request);
    }
  }

  Permit permit() { return stack_.operator_permits().Read().Newest().value; }

  const RigConfig config_ = ShippedRig();
  const Experiment experiment_ = ShippedExperiment();
  const Design design_ = DesignFor(config_);
  const PlannedExperiment planned_{experiment_, design_, 0.02, {0.0, 0.0}, MotionLimitsOf(config_)};
  World world_{config_};
  DriveBus drives_{&world_};
  GaugeBus gauges_{&world_};
  ClosedLines lines_;
  WiredStack stack_{config_, design_, {.buses = {&drives_, &gauges_}, .lines = &lines_}};
  std::deque<HostedTask> threads_;
  LockstepExecutor executor_;
  UnattendedRun operator_{&planned_};
  std::vector<TickRecord> ticks_;
  std::int64_t now_ns_ = 0;
};

}  // namespace flexarm
