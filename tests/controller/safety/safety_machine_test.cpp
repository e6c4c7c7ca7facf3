#include "controller/safety/safety_machine.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace flexarm {
namespace {

using enum SafetyState;

constexpr auto kCorruptedState = static_cast<SafetyState>(6);
constexpr auto kCorruptedRequest = static_cast<RequestKind>(77);

constexpr SafetyStatus In(SafetyState state, TripCause cause = TripCause::kNone) {
  return {state, cause};
}

constexpr SafetyFacts Healthy(RequestKind request = RequestKind::kNone) {
  SafetyFacts facts{};
  facts.all_reported = 1;
  facts.at_rest = 1;
  facts.request = request;
  return facts;
}

constexpr SafetyFacts With(SafetyFacts facts, std::uint8_t SafetyFacts::* flag,
                           std::uint8_t value) {
  facts.*flag = value;
  return facts;
}

constexpr SafetyFacts WithPresent(SafetyFacts facts, TripCauses present) {
  facts.present = present;
  return facts;
}

constexpr SafetyState StateAfter(SafetyState from, const SafetyFacts& facts) {
  return NextSafetyState(In(from), facts).status.state;
}

// Energy that a state permits: 0 nothing, 1 the relay, 2 torque.
constexpr int Energy(SafetyState state) {
  return TorqueAllowed(state) ? 2 : state == kArmed ? 1 : 0;
}

std::string Describe(const SafetyStatus& from, const SafetyFacts& facts, const SafetyDecision& to) {
  return std::string("from ") + ToString(from.state) + " (" + ToString(from.cause) + ") to " +
         ToString(to.status.state) + " (" + ToString(to.status.cause) + ") refusal " +
         ToString(to.refusal) + "; request " + ToString(facts.request) + " present " +
         std::to_string(facts.present) + " reported " + std::to_string(facts.all_reported) +
         " rest " + std::to_string(facts.at_rest) + " done " +
         std::to_string(facts.experiment_done) + " expired " + std::to_string(facts.stop_expired) +
         " pressed " + std::to_string(facts.reset_pressed) + " shutting down " +
         std::to_string(facts.shutting_down);
}

// "" if the transition obeys every rule of docs/safety.md, else the violated rule. Written from the
// rules, not from the code.
const char* BrokenRule(const SafetyStatus& from, const SafetyFacts& facts,
                       const SafetyDecision& decision) {
  const SafetyStatus& to = decision.status;
  const bool corrupted = from.state > kTripped;
  const bool healthy = facts.present == 0;
  const bool asked = facts.request != RequestKind::kNone;
  const bool moved = to.state != from.state;

  if (to.state > kTripped) return "no state outside the six";
  if ((to.state == kTripped) != (to.cause != TripCause::kNone)) {
    return "a cause is named exactly while tripped";
  }
  if (static_cast<int>(to.cause) >= kTripCauses) return "the cause is a known one";
  if (!healthy && to.state != kTripped) return "a cause trips from every state";
  if (corrupted && to.state != kTripped) return "a corrupted state trips";
  if (to.state == kTripped && moved && healthy && !corrupted &&
      !(from.state == kStopping && facts.stop_expired != 0 && facts.at_rest == 0)) {
    return "nothing trips without a cause";
  }
  if (to.state == kTripped && from.state != kTripped && !healthy) {
    for (int i = 1; i < kTripCauses; ++i) {
      if ((facts.present & (TripCauses{1} << i)) == 0) continue;
      if (static_cast<int>(to.cause) != i && (facts.present & 1) == 0) {
        return "the lowest number latches";
      }
      break;
    }
  }
  if (from.state == kTripped && moved) {
    if (to.state != kIdle) return "a trip is left towards Idle only";
    if (facts.request != RequestKind::kReset) return "a trip is left by the operator's reset only";
    if (facts.reset_pressed == 0) return "a trip is left after the physical reset only";
    if (facts.at_rest == 0) return "a trip is left at rest only";
    if (facts.all_reported == 0) return "a trip is left when every task has reported only";
  }
  if (from.state == kTripped && !moved && static_cast<int>(from.cause) < kTripCauses &&
      from.cause != TripCause::kNone && to.cause != from.cause) {
    return "the first cause stays latched";
  }
  if (Energy(to.state) > Energy(from.state)) {
    if (to.state == kArmed) {
      if (from.state != kIdle) return "arming starts from Idle";
      if (facts.request != RequestKind::kArm) return "nothing arms by itself";
      if (facts.at_rest == 0) return "a moving arm is not armed";
      if (facts.all_reported == 0) return "arming needs a report of every task";
    } else {
      if (from.state != kArmed) return "torque starts from Armed";
      if (to.state != kRunning) return "torque starts with Running";
      if (facts.request != RequestKind::kRun) return "nothing runs by itself";
    }
  }
  if (from.state == kRunning && to.state != kRunning && to.state != kStopping &&
      to.state != kTripped) {
    return "Running ends in Stopping";
  }
  if (from.state == kRunning && facts.experiment_done != 0 && to.state == kRunning) {
    return "the end of the experiment stops";
  }
  if (from.state == kStopping && facts.at_rest != 0 && healthy && to.state != kArmed) {
    return "Stopping ends at rest in Armed";
  }
  if (from.state == kStopping && to.state == kArmed && facts.at_rest == 0) {
    return "Stopping ends at rest";
  }
  if (from.state == kStopping && facts.stop_expired != 0 && to.state == kStopping) {
    return "Stopping ends after its time limit";
  }
  if (moved && to.state == kStarting) return "nothing goes back to Starting";
  if (facts.shutting_down != 0) {
    if (Energy(to.state) > Energy(from.state)) return "nothing starts while shutting down";
    if (to.state == kRunning || to.state == kArmed) {
      if (from.state == to.state) return "a shutdown stops the arm and disarms it";
    }
  }
  if (!asked && decision.refusal != Refusal::kNone) return "no refusal without a request";
  if (asked && decision.refusal == Refusal::kNone) {
    const bool obeyed =
        (facts.request == RequestKind::kArm && from.state == kIdle && to.state == kArmed) ||
        (facts.request == RequestKind::kRun && from.state == kArmed && to.state == kRunning) ||
        (facts.request == RequestKind::kStop && from.state == kRunning && to.state == kStopping) ||
        (facts.request == RequestKind::kStop && from.state == kStopping) ||
        (facts.request == RequestKind::kDisarm && from.state == kArmed && to.state == kIdle) ||
        (facts.request == RequestKind::kReset && from.state == kTripped && to.state == kIdle);
    if (!obeyed) return "a request that is not refused is carried out";
  }
  return "";
}

std::vector<SafetyStatus> EveryStatus() {
  std::vector<SafetyStatus> all;
  for (const SafetyState state : {kStarting, kIdle, kArmed, kRunning, kStopping, kCorruptedState}) {
    all.push_back(In(state));
  }
  all.push_back(In(static_cast<SafetyState>(255)));
  for (int cause = 0; cause <= kTripCauses; ++cause) {  // the first and the last are corrupted
    all.push_back(In(kTripped, static_cast<TripCause>(cause)));
  }
  return all;
}

std::vector<TripCauses> EverySetOfUpToTwoCauses() {
  std::vector<TripCauses> sets{0, 1, TripCauses{1} << kTripCauses, TripCauses{1} << 63};
  for (int i = 1; i < kTripCauses; ++i) {
    for (int k = i; k < kTripCauses; ++k) {
      sets.push_back((TripCauses{1} << i) | (TripCauses{1} << k));
    }
  }
  return sets;
}

constexpr RequestKind kEveryRequest[] = {
    RequestKind::kNone,   RequestKind::kArm,   RequestKind::kRun, RequestKind::kStop,
    RequestKind::kDisarm, RequestKind::kReset, kCorruptedRequest};

// 34 statuses x 329 sets of causes x 64 flags x 7 requests: every case.
TEST(SafetyMachine, EveryTransitionObeysTheRules) {
  long cases = 0;
  for (const SafetyStatus& from : EveryStatus()) {
    for (const TripCauses present : EverySetOfUpToTwoCauses()) {
      for (unsigned flags = 0; flags < 64; ++flags) {
        for (const RequestKind request : kEveryRequest) {
          SafetyFacts facts{};
          facts.present = present;
          facts.all_reported = flags & 1u;
          facts.at_rest = (flags >> 1) & 1u;
          facts.experiment_done = (flags >> 2) & 1u;
          facts.stop_expired = (flags >> 3) & 1u;
          facts.reset_pressed = (flags >> 4) & 1u;
          facts.shutting_down = (flags >> 5) & 1u;
          facts.request = request;
          const SafetyDecision to = NextSafetyState(from, facts);
          const char* broken = BrokenRule(from, facts, to);
          ASSERT_STREQ(broken, "") << Describe(from, facts, to);
          ++cases;
        }
      }
    }
  }
  EXPECT_EQ(cases, 34L * 329 * 64 * 7);
}

TEST(SafetyMachine, AShutdownEndsARunInIdleWithoutARequest) {
  const auto shutting_down = [](SafetyFacts facts) {
    return With(facts, &SafetyFacts::shutting_down, 1);
  };
  EXPECT_EQ(StateAfter(kRunning, shutting_down(Healthy())), kStopping);
  EXPECT_EQ(StateAfter(kStopping, shutting_down(Healthy())), kArmed);
  EXPECT_EQ(StateAfter(kArmed, shutting_down(Healthy())), kIdle);
  EXPECT_EQ(StateAfter(kIdle, shutting_down(Healthy())), kIdle);
  EXPECT_EQ(NextSafetyState(In(kIdle), shutting_down(Healthy(RequestKind::kArm))).refusal,
            Refusal::kShuttingDown);
  EXPECT_EQ(NextSafetyState(In(kArmed), shutting_down(Healthy(RequestKind::kRun))).refusal,
            Refusal::kShuttingDown);
}

// Transitions that must happen: a machine that never moves would satisfy the rules above.
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
  EXPECT_EQ(StateAfter(kArmed, Healthy(RequestKind::kDisarm)), kIdle);
}

TEST(SafetyMachine, StoppingThatLastsTooLongTrips) {
  SafetyFacts facts = With(Healthy(), &SafetyFacts::at_rest, 0);
  facts.stop_expired = 1;
  EXPECT_EQ(NextSafetyState(In(kStopping), facts).status, In(kTripped, TripCause::kStopTimeout));
  EXPECT_EQ(StateAfter(kRunning, facts), kRunning) << "the time limit applies to Stopping only";
  facts.present = CauseBit(TripCause::kEmergencyStop);
  EXPECT_EQ(NextSafetyState(In(kStopping), facts).status, In(kTripped, TripCause::kEmergencyStop));
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
  EXPECT_EQ(refusal(kIdle, Healthy(RequestKind::kRun)), Refusal::kWrongState);
  EXPECT_EQ(refusal(kRunning, Healthy(RequestKind::kDisarm)), Refusal::kWrongState);
  EXPECT_EQ(refusal(kStopping, Healthy(RequestKind::kDisarm)), Refusal::kWrongState);
  EXPECT_EQ(
      refusal(kIdle, WithPresent(Healthy(RequestKind::kArm), CauseBit(TripCause::kEmergencyStop))),
      Refusal::kUnhealthy);
  EXPECT_EQ(refusal(kArmed, Healthy(kCorruptedRequest)), Refusal::kWrongState);
}

TEST(SafetyMachine, EveryRefusalHasATextThatSaysWhatToDo) {
  for (const RequestKind request : kEveryRequest) {
    for (const SafetyState state : {kStarting, kIdle, kArmed, kRunning, kStopping, kTripped}) {
      EXPECT_STREQ(RefusalText(request, Refusal::kNone, state), "");
      for (int i = 1; i <= static_cast<int>(Refusal::kShuttingDown); ++i) {
        EXPECT_STRNE(RefusalText(request, static_cast<Refusal>(i), state), "");
        EXPECT_STRNE(ToString(static_cast<Refusal>(i)), "corrupted");
      }
    }
  }
  EXPECT_NE(std::string(RefusalText(RequestKind::kDisarm, Refusal::kWrongState, kRunning))
                .find("flexarm stop"),
            std::string::npos);
}

// Also at compile time: the state machine is a constant expression.
static_assert(NextSafetyState(In(kCorruptedState), Healthy()).status ==
              In(kTripped, TripCause::kStateNotFinite));
static_assert(NextSafetyState(In(kTripped, static_cast<TripCause>(200)), Healthy()).status ==
              In(kTripped, TripCause::kStateNotFinite));
static_assert(noexcept(NextSafetyState(SafetyStatus{}, SafetyFacts{})));

// One random tick: mostly healthy, so that sequences reach Running.
SafetyFacts DecodeFacts(std::uint32_t bits) {
  SafetyFacts facts{};
  if ((bits & 0xfu) == 0) {
    facts.present = TripCauses{1} << ((bits >> 4) % (kTripCauses - 1) + 1);
  }
  facts.all_reported = ((bits >> 10) & 3u) != 0;
  facts.at_rest = ((bits >> 12) & 3u) != 0;
  facts.experiment_done = ((bits >> 14) & 7u) == 0;
  facts.stop_expired = ((bits >> 17) & 7u) == 0;
  facts.reset_pressed = (bits >> 20) & 1u;
  facts.request = static_cast<RequestKind>((bits >> 21) % 6);
  return facts;
}

TEST(SafetyMachine, NoSequenceOfFactsReachesTorqueWithoutArmAndRun) {
  setenv("RC_PARAMS", "seed=20261120 max_success=3000 max_size=200", 0);  // repeatable
  long torque_ticks = 0;
  long trips = 0;
  const bool held = rc::check("torque only by arm then run, trips latch", [&] {
    const auto ticks = *rc::gen::container<std::vector<std::uint32_t>>(
        rc::gen::inRange<std::uint32_t>(0, UINT32_MAX));
    SafetyStatus status = In(kStarting);
    bool armed_by_operator = false;  // since the relay was last open
    bool run_by_operator = false;    // since Armed
    for (const std::uint32_t bits : ticks) {
      const SafetyFacts facts = DecodeFacts(bits);
      const SafetyStatus before = status;
      const SafetyDecision decision = NextSafetyState(status, facts);
      status = decision.status;
      RC_ASSERT(std::string(BrokenRule(before, facts, decision)) == "");

      if (Energy(before.state) == 0 && facts.request == RequestKind::kArm) armed_by_operator = true;
      if (before.state == kArmed && facts.request == RequestKind::kRun) run_by_operator = true;
      if (Energy(status.state) >= 1) RC_ASSERT(armed_by_operator);
      if (Energy(status.state) == 2) RC_ASSERT(armed_by_operator && run_by_operator);
      if (Energy(status.state) == 0) armed_by_operator = false;
      if (status.state == kArmed && before.state != kArmed) run_by_operator = false;
      if (Energy(status.state) == 0) run_by_operator = false;
      torque_ticks += TorqueAllowed(status.state);
      trips += before.state != kTripped && status.state == kTripped;

      // The same facts without the request never lead to a state with more energy.
      SafetyFacts silent = facts;
      silent.request = RequestKind::kNone;
      RC_ASSERT(Energy(NextSafetyState(status, silent).status.state) <= Energy(status.state));
    }
  });
  EXPECT_TRUE(held);
  EXPECT_GT(torque_ticks, 1000) << "the sequences must reach what they are to test";
  EXPECT_GT(trips, 1000);
}

}  // namespace
}  // namespace flexarm
