#include "controller/tasks/wired_stack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "controller/design/run_design.h"
#include "controller/operator/unattended_run.h"
#include "controller/realtime/lockstep_executor.h"
#include "controller/runlog/metrics.h"
#include "controller/types/rejected_error.h"
#include "hal/sim/simulated_rig.h"
#include "tests/controller/loop/simulated_runs.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

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
  std::int64_t worst_case_ns() const noexcept override { return 0; }
  void Open() override {}
  BusStatus Exchange(const BusCommand& command, SensorFrame* part) noexcept override {
    ++exchanges;
    last = command;
    world_->AdvanceTo(exchanges * 20 * kMs);
    world_->rig.SetTorque(command.enabled ? command.torque_nm : std::array<double, 2>{});
    world_->frame = world_->rig.Sample(world_->now_ns);
    *part = world_->frame;
    part->strain_valid = 0;
    return exchanges >= fail_from && exchanges < fail_until ? failure : BusStatus::kOk;
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
  BusStatus failure = BusStatus::kTimeout;
  BusCommand last{};

 private:
  World* world_;
};

class GaugeBus final : public BusDevice {
 public:
  explicit GaugeBus(World* world) : world_(world) {}

  const char* name() const noexcept override { return "gauges"; }
  std::int64_t worst_case_ns() const noexcept override { return 0; }
  void Open() override {}
  BusStatus Exchange(const BusCommand&, SensorFrame* part) noexcept override {
    *part = world_->frame;
    part->counter_valid = 0;
    part->levels = levels;
    return status;
  }
  LineLevels lines() const noexcept override { return own_lines; }
  BusStatus Reconnect() noexcept override { return status; }
  void Close() noexcept override {}

  BusStatus status = BusStatus::kOk;
  LineLevels own_lines = LineBit(Line::kLimit2High) | LineBit(Line::kResetButton);
  LineLevels levels = LineBit(Line::kLimit2High);

 private:
  World* world_;
};

class Lines final : public SafetyLines {
 public:
  Reading Read(std::int64_t) noexcept override { return {.levels = levels}; }
  Call Write(std::int64_t, const Outputs& outputs) noexcept override {
    relay = outputs.relay_closed;
    return {};
  }

  LineLevels levels = kHealthyLevels;
  bool relay = false;
};

class WiredStackTest : public testing::Test {
 protected:
  WiredStackTest() {
    for (Task* task : stack_.tasks()) executor_.Add(*task);
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
  Lines lines_;
  WiredStack stack_{config_, design_, {.buses = {&drives_, &gauges_}, .lines = &lines_}};
  LockstepExecutor executor_;
  UnattendedRun operator_{&planned_};
  std::vector<TickRecord> ticks_;
  std::int64_t now_ns_ = 0;
};

// The bars of the in-process backend: the same arm and instants, with other wiring.
TEST_F(WiredStackTest, AnExperimentOverTwoBusesMeetsTheBarsOfTheInProcessBackend) {
  RunUntil(9'000 * kMs);
  EXPECT_EQ(permit().state, SafetyState::kIdle) << ToString(permit().cause);
  EXPECT_TRUE(operator_.ran());
  const RunMetrics metrics = ComputeMetrics(ticks_, experiment_, 0.02,
                                            TipGeometryOf(config_.arm, config_.controller.nominal));
  EXPECT_EQ(metrics.ticks, 300);
  EXPECT_LE(metrics.joint_rms_error_deg[0], 0.90);  // docs/theory/control-law.md 12.7
  EXPECT_LE(metrics.joint_rms_error_deg[1], 1.35);
}

// OperatorTask makes this check before it loads an experiment.
TEST_F(WiredStackTest, AHardwareRigRefusesSimulationEvents) {
  EXPECT_FALSE(stack_.simulated());
  EXPECT_NO_THROW(RefuseSimEvents(experiment_));
  const std::string message =
      MessageOf<RejectedError>([] { RefuseSimEvents(ShippedExperiment("payload-dropped")); });
  EXPECT_THAT(message, testing::HasSubstr("sim_event[0]"));
}

TEST_F(WiredStackTest, TheDriveBusGetsNoTorqueBeforeTheRunAndNoneAfter) {
  RunUntil(600 * kMs);
  EXPECT_FALSE(drives_.last.enabled);
  RunUntil(9'000 * kMs);
  EXPECT_FALSE(drives_.last.enabled);
  EXPECT_EQ(drives_.last.torque_nm, (std::array<double, 2>{0.0, 0.0}));
  EXPECT_FALSE(lines_.relay);
}

TEST_F(WiredStackTest, TheEstimatorIsToldNoTorqueOfADriveThatIsNotOn) {
  const auto told = [this] { return ticks_.back().input.applied_torque_nm; };
  RunUntil(2'000 * kMs);
  ASSERT_EQ(permit().state, SafetyState::kRunning);
  EXPECT_NE(told(), (std::array<double, 2>{0.0, 0.0}));
  drives_.confirms = false;
  RunUntil(2'100 * kMs);
  EXPECT_EQ(told(), (std::array<double, 2>{0.0, 0.0}));
}

TEST_F(WiredStackTest, OneFailedExchangeIsSurvivedTwoAreALostBus) {
  drives_.fail_from = 100;
  drives_.fail_until = 101;
  RunUntil(3'000 * kMs);
  EXPECT_EQ(permit().state, SafetyState::kRunning) << ToString(permit().cause);
  drives_.fail_from = drives_.exchanges + 1;
  drives_.fail_until = INT64_MAX;
  RunUntil(now_ns_ + 100 * kMs);
  EXPECT_EQ(permit().state, SafetyState::kTripped);
  EXPECT_EQ(permit().cause, TripCause::kBusLost) << ToString(permit().cause);
  EXPECT_FALSE(lines_.relay);
}

// The trip names the bus, and the stack gives the fault of that bus as text.
TEST_F(WiredStackTest, ALostBusIsNamedInTheTripAndInTheHealth) {
  RunUntil(2'000 * kMs);
  ASSERT_EQ(stack_.buses().size(), 2U);
  EXPECT_TRUE(stack_.buses()[1].ok);
  EXPECT_EQ(stack_.BusText(permit().cause, permit().evidence), "");
  gauges_.status = BusStatus::kMalformed;
  RunUntil(now_ns_ + 100 * kMs);
  EXPECT_EQ(permit().cause, TripCause::kBusLost) << ToString(permit().cause);
  EXPECT_EQ(permit().evidence.channel, 2U);
  EXPECT_EQ(stack_.BusText(permit().cause, permit().evidence), "gauges: malformed reply");
  const std::vector<BusHealth> health = stack_.buses();
  EXPECT_TRUE(health[0].ok);
  EXPECT_EQ(health[0].failed, 0U);
  EXPECT_FALSE(health[1].ok);
  EXPECT_EQ(health[1].fault, "gauges: malformed reply");
  EXPECT_GE(health[1].failed, 2U);
  gauges_.status = BusStatus::kOk;
  RunUntil(now_ns_ + 100 * kMs);
  EXPECT_TRUE(stack_.buses()[1].ok);
  EXPECT_EQ(stack_.buses()[1].recovered, 1U);
  EXPECT_EQ(stack_.BusText(permit().cause, permit().evidence), "gauges: malformed reply")
      << "the trip keeps what caused it";
}

TEST_F(WiredStackTest, ADriveFaultTripsWithItsOwnCause) {
  RunUntil(2'000 * kMs);
  drives_.failure = BusStatus::kDriveFault;
  drives_.fail_from = drives_.exchanges + 1;
  RunUntil(now_ns_ + 60 * kMs);
  EXPECT_EQ(permit().cause, TripCause::kDriveFault) << ToString(permit().cause);
}

// A remote input reads limit switch 2 as well, once a period; its other inputs are not wired.
TEST_F(WiredStackTest, ASwitchThatABusReadsTripsThoughTheLineOfTheSafetyChainIsClosed) {
  RunUntil(2'000 * kMs);
  ASSERT_EQ(permit().state, SafetyState::kRunning) << ToString(permit().cause);
  gauges_.levels = 0;
  RunUntil(now_ns_ + 40 * kMs);
  EXPECT_EQ(permit().state, SafetyState::kTripped);
  EXPECT_EQ(permit().cause, TripCause::kLimitSwitch2High) << ToString(permit().cause);
  EXPECT_EQ(permit().levels, kHealthyLevels & ~LineBit(Line::kLimit2High));
  EXPECT_FALSE(lines_.relay);
}

TEST_F(WiredStackTest, ASwitchOfTheSafetyChainTripsThoughTheBusReadsItAsClosed) {
  RunUntil(2'000 * kMs);
  lines_.levels &= ~LineBit(Line::kLimit2High);
  RunUntil(now_ns_ + 20 * kMs);
  EXPECT_EQ(permit().cause, TripCause::kLimitSwitch2High) << ToString(permit().cause);
}

TEST_F(WiredStackTest, AFailedExchangeOpensNoSwitchAndAButtonOnTheBusIsPressed) {
  RunUntil(200 * kMs);
  gauges_.levels |= LineBit(Line::kResetButton);
  RunUntil(now_ns_ + 100 * kMs);  // the exchange, then 50 ms
  EXPECT_EQ(permit().levels, kHealthyLevels | LineBit(Line::kResetButton));
  gauges_.levels = 0;
  gauges_.status = BusStatus::kTimeout;
  RunUntil(now_ns_ + 20 * kMs);
  EXPECT_EQ(permit().levels, kHealthyLevels | LineBit(Line::kResetButton));
}

TEST_F(WiredStackTest, ALostBusIsReconnectedOnlyWhileDisarmed) {
  RunUntil(2'000 * kMs);
  ASSERT_EQ(permit().state, SafetyState::kRunning);
  drives_.fail_from = drives_.exchanges + 1;
  drives_.fail_until = drives_.exchanges + 20;
  RunUntil(now_ns_ + 40 * kMs);
  EXPECT_EQ(drives_.reconnects, 0) << "powered: exchanges only, no reconnection";
  RunUntil(now_ns_ + 600 * kMs);
  EXPECT_EQ(permit().state, SafetyState::kTripped);
  EXPECT_GT(drives_.reconnects, 0);
  const std::int64_t before = drives_.reconnects;
  RunUntil(now_ns_ + 200 * kMs);
  EXPECT_EQ(drives_.reconnects, before) << "the bus is back: exchanges again";
}

}  // namespace
}  // namespace flexarm
