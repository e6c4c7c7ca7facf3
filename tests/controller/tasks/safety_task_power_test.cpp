#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

// Arming with the drives' voltage as a witness: each channel of the power path is tested alone.

namespace flexarm {
namespace {

using enum SafetyState;

class PowerPathTest : public SafetyTaskTest {
 protected:
  PowerPathTest() : SafetyTaskTest(kWitnessLimits) { drive_.supply = &lines_; }

  // Asks to arm and runs until `state`.
  void ArmUntil(SafetyState state) {
    arm_ = Ask(RequestKind::kArm);
    for (int ms = 0; ms < 500 && safety_.status().state != state; ++ms) RunFor(kMs);
    ASSERT_EQ(safety_.status().state, state) << ToString(safety_.status().state);
  }

  void ArmedWithVoltage() {
    GoTo(kIdle);
    ArmUntil(kArmed);
    EXPECT_EQ(Answer(), Refusal::kNone);
  }

  // The answer to the arm request; kBusy: none yet.
  Refusal Answer() {
    RequestAnswer answer{};
    while (answers_.Pop(&answer)) {
      if (answer.number == arm_) return answer.refusal;
    }
    return Refusal::kBusy;
  }

  void ExpectTripped(LineTrouble trouble) {
    EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kSafetyLines}))
        << ToString(safety_.status().state);
    EXPECT_EQ(permit().evidence.channel, static_cast<std::uint32_t>(trouble));
    EXPECT_FALSE(lines_.relay_closed());
  }

  // States in the order in which they were entered, from the log.
  std::vector<SafetyState> Entered() {
    std::vector<SafetyState> states;
    for (const SafetyRecord& record : Records()) {
      if (record.after.state != record.before.state) states.push_back(record.after.state);
    }
    return states;
  }

  std::uint32_t arm_ = 0;
};

TEST_F(PowerPathTest, ArmingTestsThePumpThenTheRelayThenBothAndAnswersAtTheEnd) {
  GoTo(kIdle);
  lines_.written.clear();
  const std::int64_t asked_ns = executor_.next_ns();
  arm_ = Ask(RequestKind::kArm);
  while (safety_.status().state != kArmed && executor_.next_ns() < asked_ns + 500 * kMs) {
    RunFor(kMs);
    const SafetyState state = safety_.status().state;
    EXPECT_EQ(Answer(), state == kArmed ? Refusal::kNone : Refusal::kBusy);
    EXPECT_EQ(drive_.torque_nm[0], 0.0);
    EXPECT_EQ(drive_.report.power, DrivePower::kOff);
    if (state != kTestingPower && state != kArmed) {
      EXPECT_FALSE(lines_.power(executor_.next_ns() - kMs)) << ToString(state);
    }
  }
  EXPECT_EQ(Entered(), (std::vector{kIdle, kTestingPump, kTestingRelay, kTestingPower, kArmed}));
  // Two rise times, and a charge of 30 ms.
  EXPECT_NEAR(static_cast<double>(executor_.next_ns() - asked_ns) * 1e-6, 155.0, 10.0);
  RunFor(1000 * kMs);
  EXPECT_EQ(safety_.status().state, kArmed);
}

// The monostable of the pump dies away in 5 ms, and only then the relay closes.
TEST_F(PowerPathTest, PumpAndRelayNeverOverlapInTheTests) {
  GoTo(kIdle);
  ArmUntil(kTestingPower);
  std::int64_t toggled_ns = INT64_MIN, closed_ns = INT64_MIN;
  bool level = false;
  for (const FakeLines::Written& written : lines_.written) {
    if (written.outputs.relay_closed && closed_ns == INT64_MIN) closed_ns = written.now_ns;
    if (closed_ns == INT64_MIN && written.outputs.pump_level != level) toggled_ns = written.now_ns;
    level = written.outputs.pump_level;
  }
  ASSERT_NE(toggled_ns, INT64_MIN);
  ASSERT_NE(closed_ns, INT64_MIN);
  EXPECT_EQ(closed_ns - toggled_ns, 2 * SafetyLines::kPumpTimeoutNs);
}

TEST_F(PowerPathTest, AWeldedRelayIsFoundByTheTestOfThePump) {
  GoTo(kIdle);
  lines_.welded = true;
  RunFor(1000 * kMs);
  ASSERT_EQ(safety_.status().state, kIdle) << "nothing shows while the pump is off";
  ArmUntil(kTripped);
  ExpectTripped(LineTrouble::kRelayStuckClosed);
  EXPECT_EQ(Entered(), (std::vector{kIdle, kTestingPump, kTripped}));
  EXPECT_EQ(Answer(), Refusal::kUnhealthy);
  RunFor(200 * kMs);
  lines_.welded = false;
  EXPECT_EQ(Reset(), Refusal::kNone);
}

TEST_F(PowerPathTest, AStuckChargePumpIsFoundByTheTestOfTheRelay) {
  GoTo(kIdle);
  lines_.pump_stuck = true;
  ArmUntil(kTripped);
  ExpectTripped(LineTrouble::kPumpStuckOn);
  EXPECT_EQ(Entered(), (std::vector{kIdle, kTestingPump, kTestingRelay, kTripped}));
  EXPECT_EQ(Answer(), Refusal::kUnhealthy);
}

TEST_F(PowerPathTest, OneDriveWithVoltageIsEnoughToFail) {
  GoTo(kIdle);
  ArmUntil(kTestingRelay);
  drive_.always_up = 0b10;
  RunFor(3 * kMs);
  ExpectTripped(LineTrouble::kPumpStuckOn);
}

TEST_F(PowerPathTest, AVoltageThatDoesNotComeTripsBeforeTheDrivesAreEnabled) {
  GoTo(kIdle);
  drive_.mains = false;
  ArmUntil(kTestingPower);
  RunFor(119 * kMs);
  EXPECT_EQ(safety_.status().state, kTestingPower);
  RunFor(5 * kMs);
  ExpectTripped(LineTrouble::kVoltageMissing);
  EXPECT_NEAR(permit().evidence.value, 0.121, 1e-9);
  EXPECT_NEAR(permit().evidence.limit, 0.12, 1e-9);
  EXPECT_EQ(Answer(), Refusal::kUnhealthy);
}

TEST_F(PowerPathTest, AVoltageThatIsNotKnownNeitherBeginsNorPassesATest) {
  GoTo(kIdle);
  drive_.silent = 0b01;
  RunFor(5 * kMs);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kRelayClosed);
  for (const SafetyState test : {kTestingPump, kTestingRelay, kTestingPower}) {
    SCOPED_TRACE(ToString(test));
    drive_.silent = 0;
    RunFor(200 * kMs);
    ASSERT_NO_FATAL_FAILURE(ArmUntil(test));
    drive_.silent = test == kTestingPower ? 0b11 : 0b01;
    RunFor(119 * kMs);
    EXPECT_EQ(safety_.status().state, test);
    RunFor(5 * kMs);
    ExpectTripped(LineTrouble::kVoltageUnknown);
    EXPECT_EQ(Answer(), Refusal::kUnhealthy);
    drive_.silent = 0;
    RunFor(200 * kMs);
    ASSERT_EQ(Reset(), Refusal::kNone);
  }
}

// Both channels are stuck, or a second supply: seen without any test.
TEST_F(PowerPathTest, VoltageOfAnOpenPathIsNotArmedAndTrips) {
  ArmedWithVoltage();
  lines_.welded = lines_.pump_stuck = true;
  Ask(RequestKind::kDisarm);
  RunFor(20 * kMs);
  ASSERT_EQ(safety_.status().state, kIdle);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kRelayClosed);
  RunUntilTripped(200 * kMs);
  ExpectTripped(LineTrouble::kVoltageStaysOn);
  EXPECT_EQ(Reset(), Refusal::kCauseRemains);
  lines_.welded = lines_.pump_stuck = false;
  RunFor(100 * kMs);
  EXPECT_EQ(Reset(), Refusal::kNone);
}

TEST_F(PowerPathTest, AVoltageThatGoesWhileArmedTrips) {
  ArmedWithVoltage();
  drive_.mains = false;
  const std::int64_t gone_ns = executor_.next_ns();
  // 40 ms of the DC link, rise time and report.
  EXPECT_NEAR(static_cast<double>(RunUntilTripped(1000 * kMs) - gone_ns), 162e6, 3e6);
  ExpectTripped(LineTrouble::kVoltageMissing);
}

TEST_F(PowerPathTest, AfterADisarmTheNextArmWaitsForTheVoltageToFall) {
  ArmedWithVoltage();
  Ask(RequestKind::kDisarm);
  RunFor(10 * kMs);
  ASSERT_EQ(safety_.status().state, kIdle);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kRelayClosed);
  RunFor(60 * kMs);
  ArmUntil(kArmed);
  EXPECT_EQ(Answer(), Refusal::kNone);
}

class PowerPathTestState : public PowerPathTest, public testing::WithParamInterface<SafetyState> {};

INSTANTIATE_TEST_SUITE_P(In, PowerPathTestState,
                         testing::Values(kTestingPump, kTestingRelay, kTestingPower),
                         [](const testing::TestParamInfo<SafetyState>& tested) {
                           return std::string(ToString(tested.param));
                         });

TEST_P(PowerPathTestState, EndsByWhatEndsAnArming) {
  struct End {
    const char* name;
    std::function<void()> begin;
    std::int64_t takes_ns;
    Refusal refusal;
    SafetyState state;
  };
  const std::vector<End> ends = {
      {"stop", [&] { stop_.Set(++number_); }, kMs, Refusal::kCancelled, kIdle},
      {"disarm", [&] { disarm_.Set(++number_); }, kMs, Refusal::kCancelled, kIdle},
      {"moves", [&] { control_.report.at_rest = false; }, 31 * kMs, Refusal::kNotAtRest, kIdle},
      {"emergency stop", [&] { lines_.levels &= ~LineBit(Line::kEmergencyStop); }, 2 * kMs,
       Refusal::kUnhealthy, kTripped},
      {"shutdown", [&] { shutting_down_ = true; }, kMs, Refusal::kShuttingDown, kIdle}};
  RunFor(100 * kMs);
  for (const End& end : ends) {
    SCOPED_TRACE(end.name);
    ASSERT_NO_FATAL_FAILURE(ArmUntil(GetParam()));
    end.begin();
    RunFor(end.takes_ns);
    EXPECT_EQ(safety_.status().state, end.state);
    EXPECT_FALSE(lines_.relay_closed());
    EXPECT_FALSE(lines_.written.back().outputs.pump_level);
    EXPECT_EQ(Answer(), end.refusal);
    control_.report.at_rest = true;
    lines_.levels = kHealthyLevels;
    RunFor(200 * kMs);
    if (end.state == kTripped) {
      ASSERT_EQ(Reset(), Refusal::kNone);
    }
  }
}

// The relay's mirror contact, besides: it follows its coil, welded or not.
class PowerPathWithContact : public PowerPathTest {
 protected:
  // Runs for `duration_ns`; the contact follows the relay after `delay_ms`.
  void RunWithContact(std::int64_t duration_ns, int delay_ms) {
    for (std::int64_t t = 0; t < duration_ns; t += kMs) {
      const std::size_t n = lines_.written.size();
      const auto delay = static_cast<std::size_t>(delay_ms);
      const bool closed = n > delay && lines_.written[n - 1 - delay].outputs.relay_closed;
      lines_.relay = closed ? RelayContact::kClosed : RelayContact::kOpen;
      RunFor(kMs);
    }
  }
};

TEST_F(PowerPathWithContact, OfFiftyMillisecondsIsFineAndOfAHundredAndFiftyTrips) {
  lines_.relay = RelayContact::kOpen;
  GoTo(kIdle);
  arm_ = Ask(RequestKind::kArm);
  RunWithContact(500 * kMs, 50);
  EXPECT_EQ(safety_.status().state, kArmed);
  EXPECT_EQ(Answer(), Refusal::kNone);
  disarm_.Set(++number_);
  RunWithContact(500 * kMs, 50);
  ASSERT_EQ(safety_.status().state, kIdle);
  arm_ = Ask(RequestKind::kArm);
  RunWithContact(500 * kMs, 150);
  EXPECT_EQ(safety_.status(), (SafetyStatus{kTripped, TripCause::kSafetyLines}));
  EXPECT_EQ(Answer(), Refusal::kUnhealthy);
  EXPECT_EQ(permit().evidence.channel, static_cast<std::uint32_t>(LineTrouble::kRelayStuckOpen));
}

TEST_F(PowerPathWithContact, ACutWireOfTheContactIsNotArmed) {
  lines_.relay = RelayContact::kOpen;
  GoTo(kIdle);
  lines_.relay = RelayContact::kClosed;
  RunFor(50 * kMs);
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kRelayClosed);
}

TEST_F(SafetyTaskTest, WithoutAWitnessOfTheVoltageNothingIsTested) {
  drive_.supply = &lines_;  // they report it, but it is not known to hang on the relay
  drive_.always_up = 0b11;
  GoTo(kArmed);
  for (const SafetyRecord& record : Records()) EXPECT_EQ(record.facts.tests_power, 0);
}

}  // namespace
}  // namespace flexarm
