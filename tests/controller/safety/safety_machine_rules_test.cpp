// The rules of docs/safety.md, for every transition and for random sequences.

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/controller/safety/machine_facts.h"

namespace flexarm {
namespace {

using enum SafetyState;

std::string Describe(const SafetyStatus& from, const SafetyFacts& facts, const SafetyDecision& to) {
  return std::string("from ") + ToString(from.state) + " (" + ToString(from.cause) + ") to " +
         ToString(to.status.state) + " (" + ToString(to.status.cause) + ") refusal " +
         ToString(to.refusal) + "; request " + ToString(facts.request) + " present " +
         std::to_string(facts.present) + " reported " + std::to_string(facts.all_reported) +
         " rest " + std::to_string(facts.at_rest) + " done " +
         std::to_string(facts.experiment_done) + " expired " + std::to_string(facts.stop_expired) +
         " pressed " + std::to_string(facts.reset_pressed) + " shutting down " +
         std::to_string(facts.shutting_down) + " may damp " + std::to_string(facts.may_damp) +
         " drives on " + std::to_string(facts.drives_on) + " off " +
         std::to_string(facts.drives_off) + " tests power " + std::to_string(facts.tests_power) +
         " power follows " + std::to_string(facts.power_follows);
}

bool Tests(SafetyState state) {
  return state == kTestingPump || state == kTestingRelay || state == kTestingPower;
}

bool Corrupted(SafetyState state) { return static_cast<int>(state) >= kSafetyStates; }

// Angle, rate and bending: docs/safety.md, "Stop categories".
bool OfCategory1(TripCauses causes) {
  constexpr TripCauses kAngleRateBending = 0b111111ULL << 6;  // numbers 6 to 11
  return causes != 0 && (causes & ~kAngleRateBending) == 0;
}

// "" if the transition obeys every rule of docs/safety.md, else the violated rule. Written from the
// rules, not from the code.
const char* BrokenRule(const SafetyStatus& from, const SafetyFacts& facts,
                       const SafetyDecision& decision) {
  const SafetyStatus& to = decision.status;
  const bool corrupted = Corrupted(from.state);
  const bool healthy = facts.present == 0;
  const bool asked = facts.request != RequestKind::kNone;
  const bool moved = to.state != from.state;

  const bool latches = to.state == kTripped || to.state == kFaultStopping;
  const bool latched = from.state == kTripped || from.state == kFaultStopping;
  if (Corrupted(to.state)) return "no state outside the eleven";
  if (latches != (to.cause != TripCause::kNone)) {
    return "a cause is named exactly while one is latched";
  }
  if (static_cast<int>(to.cause) >= kTripCauses) return "the cause is a known one";
  if (!healthy && !latches) return "a cause latches from every state";
  if (to.state == kFaultStopping) {
    if (Energy(from.state) < 2) return "only an arm that has torque is damped";
    if (!healthy && !OfCategory1(facts.present)) return "only angle, rate, bending are damped";
    if (facts.may_damp == 0) return "damping needs good sensors and drives";
    if (from.state == to.state && (facts.stop_expired != 0 || facts.at_rest != 0)) {
      return "damping ends at rest, and in time";
    }
  }
  if (OfCategory1(facts.present) && facts.may_damp != 0 && Energy(from.state) == 2 &&
      from.state != kFaultStopping && to.state != kFaultStopping) {
    return "an arm that can be damped is";
  }
  if (corrupted && to.state != kTripped) return "a corrupted state trips";
  if (from.state == kFaultStopping && !latches) return "FaultStopping ends in Tripped";
  if (to.state == kTripped && moved && healthy && !corrupted && !latched &&
      !(from.state == kStopping && facts.stop_expired != 0 && facts.at_rest == 0)) {
    return "nothing trips without a cause";
  }
  if (latches && !latched && !healthy) {
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
  if (latched && latches && static_cast<int>(from.cause) < kTripCauses &&
      from.cause != TripCause::kNone && to.cause != from.cause) {
    return "the first cause stays latched";
  }
  if (to.state == kArmed && from.state == kDisarming) return "a disarm is not taken back";
  if (from.state == kArmed && to.state == kIdle) return "the drives are off before the relay opens";
  if (from.state == kDisarming && to.state != kDisarming) {
    if (!latches && to.state != kIdle) return "Disarming ends in Idle";
    if (healthy && facts.drives_off == 0 && facts.stop_expired == 0) {
      return "the relay waits for the drives";
    }
  }
  if (from.state == kDisarming && to.state == kDisarming &&
      (facts.drives_off != 0 || facts.stop_expired != 0)) {
    return "Disarming ends when the drives are off, and in time";
  }
  const bool tests = Tests(from.state) || Tests(to.state);
  if (from.state == kIdle && Closed(to.state) != 0) {  // the arming begins
    if (facts.request != RequestKind::kArm) return "nothing arms by itself";
    if (facts.at_rest == 0) return "a moving arm is not armed";
    if (facts.power_follows == 0) return "a power path that is not known to be open is not armed";
    if (facts.all_reported == 0) return "arming needs a report of every task";
    if ((to.state == kTestingPump) != (facts.tests_power != 0)) {
      return "arming begins with a test, if there is a witness";
    }
  }
  if (tests && moved && !latches && to.state != kIdle) {
    const bool next = (from.state == kIdle && to.state == kTestingPump) ||
                      (from.state == kTestingPump && to.state == kTestingRelay) ||
                      (from.state == kTestingRelay && to.state == kTestingPower) ||
                      (from.state == kTestingPower && to.state == kArmed);
    if (!next) return "each channel is tested, in turn, and then both";
    if (facts.power_follows == 0) return "a test that has not passed is not left forwards";
    if (facts.at_rest == 0 || facts.shutting_down != 0) return "the tests are of an arm at rest";
  }
  if (Tests(from.state) && !latches && to.state != kIdle) {
    if (facts.request == RequestKind::kStop || facts.request == RequestKind::kDisarm) {
      return "a stop or a disarm ends the tests";
    }
    if (facts.at_rest == 0) return "a moving arm ends the tests";
  }
  if (Tests(from.state) && to.state == kIdle && facts.at_rest != 0 && facts.shutting_down == 0 &&
      facts.request != RequestKind::kStop && facts.request != RequestKind::kDisarm) {
    return "the tests are not given up";
  }
  if (Tests(from.state) && to.state == from.state && facts.power_follows != 0) {
    return "a test that has passed ends";
  }
  if (Energy(to.state) > Energy(from.state) && !corrupted && !tests) {
    if (to.state == kArmed) {
      if (from.state != kIdle) return "arming starts from Idle";
    } else {
      if (from.state != kArmed) return "torque starts from Armed";
      if (to.state != kRunning) return "torque starts with Running";
      if (facts.request != RequestKind::kRun) return "nothing runs by itself";
      if (facts.drives_on == 0) return "nothing runs before the drives are on";
    }
  }
  if (from.state == kRunning && to.state != kRunning && to.state != kStopping && !latches) {
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
    if (to.state == kRunning || to.state == kArmed || Tests(to.state)) {
      if (from.state == to.state) return "a shutdown stops the arm and disarms it";
    }
  }
  if (!asked && decision.refusal != Refusal::kNone) return "no refusal without a request";
  if (asked && decision.refusal == Refusal::kNone) {
    const bool obeyed =
        (facts.request == RequestKind::kArm && from.state == kIdle &&
         (to.state == kArmed || to.state == kTestingPump)) ||
        (facts.request == RequestKind::kRun && from.state == kArmed && to.state == kRunning) ||
        (facts.request == RequestKind::kStop && from.state == kRunning && to.state == kStopping) ||
        (facts.request == RequestKind::kStop && from.state == kStopping) ||
        (facts.request == RequestKind::kChange && from.state == kRunning && to.state == kRunning &&
         facts.experiment_done == 0 && facts.shutting_down == 0) ||
        (facts.request == RequestKind::kDisarm && from.state == kArmed && to.state == kDisarming) ||
        (facts.request == RequestKind::kDisarm && from.state == kDisarming) ||
        ((facts.request == RequestKind::kStop || facts.request == RequestKind::kDisarm) &&
         Tests(from.state) && to.state == kIdle) ||
        (facts.request == RequestKind::kReset && from.state == kTripped && to.state == kIdle);
    if (!obeyed) return "a request that is not refused is carried out";
  }
  return "";
}

std::vector<SafetyStatus> EveryStatus() {
  std::vector<SafetyStatus> all;
  for (const SafetyState state : {kStarting, kIdle, kArmed, kRunning, kStopping, kDisarming,
                                  kTestingPump, kTestingRelay, kTestingPower, kCorruptedState}) {
    all.push_back(In(state));
  }
  all.push_back(In(static_cast<SafetyState>(255)));
  for (int cause = 0; cause <= kTripCauses; ++cause) {  // the first and the last are corrupted
    all.push_back(In(kTripped, static_cast<TripCause>(cause)));
  }
  for (const TripCause cause :
       {TripCause::kNone, TripCause::kSoftLimit2, TripCause::kBendingStrain1, TripCause::kBusLost,
        static_cast<TripCause>(kTripCauses)}) {
    all.push_back(In(kFaultStopping, cause));
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

// 55 statuses x 707 sets of causes x 2048 flags x 8 requests: every case.
TEST(SafetyMachine, EveryTransitionObeysTheRules) {
  long cases = 0;
  for (const SafetyStatus& from : EveryStatus()) {
    for (const TripCauses present : EverySetOfUpToTwoCauses()) {
      for (unsigned flags = 0; flags < 2048; ++flags) {
        for (const RequestKind request : kEveryRequest) {
          SafetyFacts facts{};
          facts.present = present;
          facts.all_reported = flags & 1u;
          facts.at_rest = (flags >> 1) & 1u;
          facts.experiment_done = (flags >> 2) & 1u;
          facts.stop_expired = (flags >> 3) & 1u;
          facts.reset_pressed = (flags >> 4) & 1u;
          facts.shutting_down = (flags >> 5) & 1u;
          facts.may_damp = (flags >> 6) & 1u;
          facts.drives_on = (flags >> 7) & 1u;
          facts.drives_off = (flags >> 8) & 1u;
          facts.tests_power = (flags >> 9) & 1u;
          facts.power_follows = (flags >> 10) & 1u;
          facts.request = request;
          const SafetyDecision to = NextSafetyState(from, facts);
          const char* broken = BrokenRule(from, facts, to);
          if (*broken != '\0') FAIL() << broken << ": " << Describe(from, facts, to);
          ++cases;
        }
      }
    }
  }
  EXPECT_EQ(cases, 55L * 707 * 2048 * 8);
}

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
  facts.request = static_cast<RequestKind>((bits >> 21) % 7);
  facts.may_damp = (bits >> 24) & 1u;
  facts.drives_on = ((bits >> 25) & 3u) != 0;
  facts.drives_off = (bits >> 27) & 1u;
  facts.power_follows = ((bits >> 28) & 3u) != 0;
  facts.tests_power = (bits >> 30) & 1u;
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

      if (Closed(before.state) == 0 && facts.request == RequestKind::kArm) armed_by_operator = true;
      if (before.state == kArmed && facts.request == RequestKind::kRun) run_by_operator = true;
      if (Closed(status.state) != 0) RC_ASSERT(armed_by_operator);
      if (Energy(status.state) == 2) RC_ASSERT(armed_by_operator && run_by_operator);
      if (Closed(status.state) == 0) armed_by_operator = false;
      if (status.state == kArmed && before.state != kArmed) run_by_operator = false;
      if (Energy(status.state) == 0) run_by_operator = false;
      torque_ticks += TorqueAllowed(status.state);
      trips += before.state != kTripped && status.state == kTripped;

      // The same facts without the request never lead to a state with more energy; but for the
      // tests of an arming that was requested.
      if (Tests(status.state)) continue;
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
