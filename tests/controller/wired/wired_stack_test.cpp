#include "controller/tasks/wired_stack.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "controller/runlog/metrics.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/wired/two_bus_rig.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

// The bars of the in-process backend: the same arm and instants, with other wiring.
TEST_F(WiredStackTest, AnExperimentOverTwoBusesMeetsTheBarsOfTheInProcessBackend) {
  RunUntil(9'000 * kMs);
  EXPECT_EQ(permit().state, SafetyState::kIdle) << ToString(permit().cause);
  EXPECT_TRUE(operator_.ran());
  const RunMetrics metrics = ComputeMetrics(ticks_, experiment_, 0.02, TipGeometryOf(config_));
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

// The bus is well, its gauges give no good reading: the bending limit must not compare a 0.
struct LostGauges : WiredStackTest, testing::WithParamInterface<std::uint32_t> {};

TEST_P(LostGauges, TripByTheNameOfTheirLink) {
  RunUntil(3'000 * kMs);
  ASSERT_EQ(permit().state, SafetyState::kRunning) << ToString(permit().cause);
  gauges_.lost = GetParam();
  RunUntil(now_ns_ + 80 * kMs);  // two samples, the report of the second, the bus after it
  EXPECT_EQ(permit().state, SafetyState::kTripped);
  EXPECT_EQ(permit().cause, (GetParam() & 0x3FEU) != 0 ? TripCause::kNoStrainReading1
                                                       : TripCause::kNoStrainReading2)
      << ToString(permit().cause);
  EXPECT_EQ(drives_.last.torque_nm, (std::array{0.0, 0.0}));
}

// All, all of a link, all of link 1 but one.
INSTANTIATE_TEST_SUITE_P(Of, LostGauges, testing::Values(0xFFFFFU, 0x3FFU, 0xFFC00U, 0x3FEU));

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
