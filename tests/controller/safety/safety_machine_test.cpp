#include "controller/safety/safety_machine.h"

#include <gtest/gtest.h>

#include "tests/controller/safety/machine_facts.h"

namespace flexarm {
namespace {

using enum SafetyState;

TEST(SafetyMachine, RelayAndChargePumpAreBothClosedExactlyInTheStatesWithPower) {
  for (int i = 0; i < kSafetyStates; ++i) {
    const auto state = static_cast<SafetyState>(i);
    EXPECT_EQ(RelayClosed(state), (Closed(state) & 0b10) != 0) << ToString(state);
    EXPECT_EQ(PumpRuns(state), (Closed(state) & 0b01) != 0) << ToString(state);
    EXPECT_FALSE(TestsPower(state) && DrivesEnabled(state)) << ToString(state);
  }
}

TEST(SafetyMachine, AShutdownEndsARunInIdleWithoutARequest) {
  const auto shutting_down = [](SafetyFacts facts) {
    return With(facts, &SafetyFacts::shutting_down, 1);
  };
  EXPECT_EQ(StateAfter(kRunning, shutting_down(Healthy())), kStopping);
  EXPECT_EQ(StateAfter(kStopping, shutting_down(Healthy())), kArmed);
  EXPECT_EQ(StateAfter(kArmed, shutting_down(Healthy())), kDisarming);
  EXPECT_EQ(StateAfter(kIdle, shutting_down(Healthy())), kIdle);
  EXPECT_EQ(NextSafetyState(In(kIdle), shutting_down(Healthy(RequestKind::kArm))).refusal,
            Refusal::kShuttingDown);
  EXPECT_EQ(NextSafetyState(In(kArmed), shutting_down(Healthy(RequestKind::kRun))).refusal,
            Refusal::kShuttingDown);
}

// Transitions that must happen: a machine that never moves would satisfy the rules of
// safety_machine_rules_test.cpp.
TEST(SafetyMachine, GoesThroughAnExperimentAndBack) {
  EXPECT_EQ(StateAfter(kStarting, Healthy()), kIdle);
  EXPECT_EQ(StateAfter(kStarting, With(Healthy(), &SafetyFacts::all_reported, 0)), kStarting);
  EXPECT_EQ(StateAfter(kIdle, Healthy()), kIdle);
  EXPECT_EQ(StateAfter(kIdle, Healthy(RequestKind::kArm)), kArmed);
  EXPECT_EQ(StateAfter(kArmed, Healthy()), kArmed);
  EXPECT_EQ(StateAfter(kArmed, Healthy(RequestKind::kRun)), kRunning);
  EXPECT_EQ(StateAfter(kRunning, Healthy()), kRunning);
  EXPECT_EQ(StateAfter(kRunning, Healthy(RequestKind::kStop)), kStopping);
  EXPECT_EQ(StateAfter(kRunning, With(Healthy(), &SafetyFacts::experiment_done, 1)), kStopping);
  EXPECT_EQ(StateAfter(kStopping, With(Healthy(), &SafetyFacts::at_rest, 0)), kStopping);
  EXPECT_EQ(StateAfter(kStopping, Healthy()), kArmed);
  EXPECT_EQ(StateAfter(kArmed, Healthy(RequestKind::kDisarm)), kDisarming);
  EXPECT_EQ(StateAfter(kDisarming, Healthy()), kDisarming);
  EXPECT_EQ(StateAfter(kDisarming, With(Healthy(), &SafetyFacts::drives_off, 1)), kIdle);
  EXPECT_EQ(StateAfter(kDisarming, With(Healthy(), &SafetyFacts::stop_expired, 1)), kIdle);
}

TEST(SafetyMachine, WithAWitnessArmingTestsEachChannelBeforeBoth) {
  const SafetyFacts waits =
      With(With(Healthy(), &SafetyFacts::tests_power, 1), &SafetyFacts::power_follows, 0);
  SafetyFacts passes = With(waits, &SafetyFacts::power_follows, 1);
  passes.request = RequestKind::kArm;
  EXPECT_EQ(NextSafetyState(In(kIdle), passes), (SafetyDecision{In(kTestingPump), Refusal::kNone}));
  passes.request = RequestKind::kNone;
  EXPECT_EQ(StateAfter(kTestingPump, passes), kTestingRelay);
  EXPECT_EQ(StateAfter(kTestingRelay, passes), kTestingPower);
  EXPECT_EQ(StateAfter(kTestingPower, passes), kArmed);
  for (const SafetyState test : {kTestingPump, kTestingRelay, kTestingPower}) {
    EXPECT_EQ(StateAfter(test, waits), test);
    EXPECT_EQ(StateAfter(test, With(passes, &SafetyFacts::at_rest, 0)), kIdle);
    EXPECT_EQ(StateAfter(test, With(passes, &SafetyFacts::shutting_down, 1)), kIdle);
    EXPECT_EQ(StateAfter(test, WithPresent(passes, CauseBit(TripCause::kSoftLimit1))), kTripped);
    for (const RequestKind ends : {RequestKind::kStop, RequestKind::kDisarm}) {
      SafetyFacts facts = passes;
      facts.request = ends;
      EXPECT_EQ(NextSafetyState(In(test), facts), (SafetyDecision{In(kIdle), Refusal::kNone}));
    }
  }
}

TEST(SafetyMachine, StoppingThatLastsTooLongTrips) {
  SafetyFacts facts = With(Healthy(), &SafetyFacts::at_rest, 0);
  facts.stop_expired = 1;
  EXPECT_EQ(NextSafetyState(In(kStopping), facts).status, In(kTripped, TripCause::kStopTimeout));
  EXPECT_EQ(StateAfter(kRunning, facts), kRunning) << "the time limit applies to Stopping only";
  facts.present = CauseBit(TripCause::kEmergencyStop);
  EXPECT_EQ(NextSafetyState(In(kStopping), facts).status, In(kTripped, TripCause::kEmergencyStop));
}

TEST(SafetyMachine, ACauseOfCategory1IsDampedBeforeThePowerGoes) {
  SafetyFacts facts = With(Healthy(), &SafetyFacts::at_rest, 0);
  facts.present = CauseBit(TripCause::kHubRate2) | CauseBit(TripCause::kSoftLimit1);
  const SafetyStatus damped = In(kFaultStopping, TripCause::kSoftLimit1);
  const SafetyStatus tripped = In(kTripped, TripCause::kSoftLimit1);
  EXPECT_EQ(NextSafetyState(In(kRunning), facts).status, damped);
  EXPECT_EQ(NextSafetyState(In(kStopping), facts).status, damped);
  EXPECT_EQ(NextSafetyState(In(kArmed), facts).status, tripped) << "it has no torque";
  EXPECT_EQ(NextSafetyState(damped, facts).status, damped);
  EXPECT_EQ(NextSafetyState(damped, WithPresent(facts, 0)).status, damped) << "latched";
  EXPECT_EQ(NextSafetyState(In(kRunning), With(facts, &SafetyFacts::may_damp, 0)).status, tripped);
  for (const auto flag : {&SafetyFacts::at_rest, &SafetyFacts::stop_expired}) {
    EXPECT_EQ(NextSafetyState(damped, With(facts, flag, 1)).status, tripped);
  }
  EXPECT_EQ(NextSafetyState(damped, With(facts, &SafetyFacts::may_damp, 0)).status, tripped);
  facts.present |= CauseBit(TripCause::kBusLost);
  EXPECT_EQ(NextSafetyState(In(kRunning), facts).status, tripped);
  EXPECT_EQ(NextSafetyState(damped, facts).status, tripped);
}

TEST(SafetyMachine, ARunNeedsDrivesThatAreOn) {
  const SafetyFacts off = With(Healthy(RequestKind::kRun), &SafetyFacts::drives_on, 0);
  EXPECT_EQ(NextSafetyState(In(kArmed), off), (SafetyDecision{In(kArmed), Refusal::kDrivesOff}));
}

TEST(SafetyMachine, ATripIsLeftOnlyWithBothResetsAtRestWithTheCauseGone) {
  const SafetyStatus tripped = In(kTripped, TripCause::kSoftLimit1);
  SafetyFacts facts = Healthy(RequestKind::kReset);
  facts.reset_pressed = 1;
  EXPECT_EQ(NextSafetyState(tripped, facts), (SafetyDecision{In(kIdle), Refusal::kNone}));

  EXPECT_EQ(NextSafetyState(tripped, With(facts, &SafetyFacts::reset_pressed, 0)),
            (SafetyDecision{tripped, Refusal::kNoReset}));
  EXPECT_EQ(NextSafetyState(tripped, With(facts, &SafetyFacts::at_rest, 0)),
            (SafetyDecision{tripped, Refusal::kNotAtRest}));
  EXPECT_EQ(NextSafetyState(tripped, With(facts, &SafetyFacts::all_reported, 0)),
            (SafetyDecision{tripped, Refusal::kUnhealthy}));
  EXPECT_EQ(NextSafetyState(tripped, WithPresent(facts, CauseBit(TripCause::kBusLost))),
            (SafetyDecision{tripped, Refusal::kCauseRemains}))
      << "any cause, not just the latched one; and the latched one stays";
  facts.request = RequestKind::kNone;
  EXPECT_EQ(NextSafetyState(tripped, facts), (SafetyDecision{tripped, Refusal::kNone}))
      << "the button alone does not reset";
}

TEST(SafetyMachine, RefusesWithTheReason) {
  const auto refusal = [](SafetyState from, const SafetyFacts& facts) {
    return NextSafetyState(In(from), facts).refusal;
  };
  EXPECT_EQ(refusal(kIdle, With(Healthy(RequestKind::kArm), &SafetyFacts::at_rest, 0)),
            Refusal::kNotAtRest);
  EXPECT_EQ(refusal(kIdle, With(Healthy(RequestKind::kArm), &SafetyFacts::power_follows, 0)),
            Refusal::kRelayClosed);
  EXPECT_EQ(refusal(kIdle, Healthy(RequestKind::kRun)), Refusal::kWrongState);
  EXPECT_EQ(refusal(kRunning, Healthy(RequestKind::kDisarm)), Refusal::kWrongState);
  EXPECT_EQ(refusal(kStopping, Healthy(RequestKind::kDisarm)), Refusal::kWrongState);
  EXPECT_EQ(
      refusal(kIdle, WithPresent(Healthy(RequestKind::kArm), CauseBit(TripCause::kEmergencyStop))),
      Refusal::kUnhealthy);
  EXPECT_EQ(refusal(kArmed, Healthy(kCorruptedRequest)), Refusal::kWrongState);
}

// Also at compile time: the state machine is a constant expression.
static_assert(NextSafetyState(In(kCorruptedState), Healthy()).status ==
              In(kTripped, TripCause::kStateNotFinite));
static_assert(NextSafetyState(In(kTripped, static_cast<TripCause>(200)), Healthy()).status ==
              In(kTripped, TripCause::kStateNotFinite));
static_assert(noexcept(NextSafetyState(SafetyStatus{}, SafetyFacts{})));

}  // namespace
}  // namespace flexarm
