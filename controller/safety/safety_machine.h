#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "controller/types/messages.h"
#include "controller/types/safety_state.h"
#include "controller/types/trip_cause.h"

namespace flexarm {

/// All inputs of the safety state machine in one safety tick. Logged on every change and replayed:
/// no padding. Flags are 0 or 1; any other value counts as set.
struct SafetyFacts {
  TripCauses present;            ///< all causes present now, except kStopTimeout
  std::uint8_t all_reported;     ///< every task has reported once
  std::uint8_t at_rest;          ///< a fresh report of the loop says that the arm is at rest
  std::uint8_t experiment_done;  ///< the reference of this run has ended
  std::uint8_t stop_expired;     ///< Stopping, FaultStopping, Disarming: longer than permitted
  std::uint8_t reset_pressed;    ///< the reset button was pressed after the trip
  RequestKind request;           ///< request of the operator in this tick
  std::uint8_t shutting_down;    ///< the daemon ends: the arm is stopped and disarmed
  std::uint8_t may_damp;     ///< fresh, valid sensors and healthy drives, and no cause beyond those
                             ///< with which FaultStopping began
  std::uint8_t drives_on;    ///< every drive has confirmed that it is enabled
  std::uint8_t drives_off;   ///< every drive has confirmed, in this state, that it is disabled
  std::uint8_t tests_power;  ///< the drives' voltage is a witness: arming tests the power path
  std::uint8_t power_follows;  ///< what the witnesses say of the power path is what relay and pump
                               ///< should make of it; also 1 without a witness
  std::array<std::uint8_t, 4> reserved;  ///< zero
};
static_assert(std::has_unique_object_representations_v<SafetyFacts>, "no padding: it is logged");

/// State of the safety state machine. `cause` is kNone except in FaultStopping and Tripped.
struct SafetyStatus {
  SafetyState state;
  TripCause cause;

  friend constexpr bool operator==(const SafetyStatus&, const SafetyStatus&) = default;
};

/// Next state, and the answer to the request (kNone also without a request).
struct SafetyDecision {
  SafetyStatus status;
  Refusal refusal;

  friend constexpr bool operator==(const SafetyDecision&, const SafetyDecision&) = default;
};

/// The cause that latches when several are present: the lowest number. A set without a known cause
/// is corrupt and counts as kStateNotFinite.
constexpr TripCause LowestCause(TripCauses causes) noexcept {
  const int lowest = std::countr_zero(causes);
  return lowest > 0 && lowest < kTripCauses ? static_cast<TripCause>(lowest)
                                            : TripCause::kStateNotFinite;
}

/// The state after a test of the power path that has passed.
constexpr SafetyState AfterTest(SafetyState test) noexcept {
  if (test == SafetyState::kTestingPump) return SafetyState::kTestingRelay;
  return test == SafetyState::kTestingRelay ? SafetyState::kTestingPower : SafetyState::kArmed;
}

/// Why an arm in Idle is refused; kNone: it is not.
constexpr Refusal WhyNotArm(const SafetyFacts& facts) noexcept {
  if (facts.shutting_down != 0) return Refusal::kShuttingDown;
  if (facts.all_reported == 0) return Refusal::kUnhealthy;
  if (facts.power_follows == 0) return Refusal::kRelayClosed;
  return facts.at_rest == 0 ? Refusal::kNotAtRest : Refusal::kNone;
}

/// Why a reset in Tripped is refused; kNone: it is not.
constexpr Refusal WhyNotReset(const SafetyFacts& facts) noexcept {
  if (facts.present != 0) return Refusal::kCauseRemains;
  if (facts.all_reported == 0) return Refusal::kUnhealthy;
  if (facts.reset_pressed == 0) return Refusal::kNoReset;
  return facts.at_rest == 0 ? Refusal::kNotAtRest : Refusal::kNone;
}

/// The state after a tick of a test of the power path without a cause.
constexpr SafetyState NextInTest(SafetyState test, const SafetyFacts& facts) noexcept {
  const bool cancelled =
      facts.request == RequestKind::kDisarm || facts.request == RequestKind::kStop;
  if (cancelled || facts.shutting_down != 0 || facts.at_rest == 0) return SafetyState::kIdle;
  return facts.power_follows != 0 ? AfterTest(test) : test;
}

/// What a tick of Running without a cause leads to.
constexpr SafetyDecision NextInRun(const SafetyFacts& facts) noexcept {
  const bool stops = facts.request == RequestKind::kStop;
  const bool ends = facts.experiment_done != 0 || facts.shutting_down != 0;
  const bool changes = facts.request == RequestKind::kChange && !ends;
  const bool granted = stops || changes || facts.request == RequestKind::kNone;
  return {{stops || ends ? SafetyState::kStopping : SafetyState::kRunning, TripCause::kNone},
          granted ? Refusal::kNone : Refusal::kWrongState};
}

/// FaultStopping is over: a further cause, at rest, too long, or no longer able to damp.
constexpr bool FaultStopEnds(const SafetyFacts& facts) noexcept {
  const bool further = (facts.present & ~kCategory1Causes) != 0;
  return further || facts.may_damp == 0 || facts.at_rest != 0 || facts.stop_expired != 0;
}

/// Safety state machine: a pure function of status and facts. No clock, no I/O, no memory.
///
/// A cause that is present latches from every state: it trips, or, if all present are of stop
/// category 1 and the arm may be damped, FaultStopping goes before Tripped. Tripped is left only
/// towards Idle, by the operator's reset after the physical reset button, at rest, with no cause
/// present. With a witness of the power path, arming goes through a test of the charge pump, of the
/// relay, and of both, with the drives off; a stop, a disarm or a moving arm ends it. Torque
/// becomes possible only by `run` from Armed, with the drives on. While it runs its path may be
/// changed. Armed is left through Disarming,
/// in which the drives are switched off before the relay opens. While the daemon shuts down nothing
/// starts, and the arm is stopped and disarmed. At most one transition per tick. Real-time: safe.
constexpr SafetyDecision NextSafetyState(SafetyStatus status, const SafetyFacts& facts) noexcept {
  using enum SafetyState;
  const RequestKind request = facts.request;
  const Refusal not_here = request == RequestKind::kNone ? Refusal::kNone : Refusal::kWrongState;
  const bool shutting_down = facts.shutting_down != 0;
  const auto go = [](SafetyState state, Refusal refusal) {
    return SafetyDecision{{state, TripCause::kNone}, refusal};
  };

  if (static_cast<int>(status.state) >= kSafetyStates) {  // a corrupted byte
    const TripCause cause = LowestCause(facts.present);
    return {{kTripped, cause}, not_here};
  }

  // Latched: the first cause is kept until the reset.
  const bool known =
      status.cause != TripCause::kNone && static_cast<int>(status.cause) < kTripCauses;
  const SafetyStatus latched{kTripped, known ? status.cause : TripCause::kStateNotFinite};

  if (status.state == kTripped) {
    if (request != RequestKind::kReset) return {latched, not_here};
    const Refusal refusal = WhyNotReset(facts);
    if (refusal != Refusal::kNone) return {latched, refusal};
    return go(kIdle, Refusal::kNone);
  }

  if (status.state == kFaultStopping) {
    const bool ends = !known || FaultStopEnds(facts);
    return {{ends ? kTripped : kFaultStopping, latched.cause}, not_here};
  }

  if (facts.present != 0) {
    const bool damped = TorqueAllowed(status.state) && Damped(facts.present, facts.may_damp != 0);
    return {{damped ? kFaultStopping : kTripped, LowestCause(facts.present)},
            request == RequestKind::kNone ? Refusal::kNone : Refusal::kUnhealthy};
  }

  switch (status.state) {
    case kStarting:
      return go(facts.all_reported != 0 ? kIdle : kStarting, not_here);
    case kIdle: {
      if (request != RequestKind::kArm) return go(kIdle, not_here);
      const Refusal refusal = WhyNotArm(facts);
      if (refusal != Refusal::kNone) return go(kIdle, refusal);
      return go(facts.tests_power != 0 ? kTestingPump : kArmed, refusal);
    }
    case kTestingPump:
    case kTestingRelay:
    case kTestingPower: {
      const bool ends = request == RequestKind::kDisarm || request == RequestKind::kStop;
      return go(NextInTest(status.state, facts), ends ? Refusal::kNone : not_here);
    }
    case kArmed:
      if (request == RequestKind::kDisarm) return go(kDisarming, Refusal::kNone);
      if (shutting_down) {
        return go(kDisarming, request == RequestKind::kRun ? Refusal::kShuttingDown : not_here);
      }
      if (request != RequestKind::kRun) return go(kArmed, not_here);
      return facts.drives_on != 0 ? go(kRunning, Refusal::kNone) : go(kArmed, Refusal::kDrivesOff);
    case kRunning:
      return NextInRun(facts);
    case kStopping: {
      const Refusal refusal = request == RequestKind::kStop ? Refusal::kNone : not_here;
      if (facts.at_rest != 0) return go(kArmed, refusal);
      if (facts.stop_expired != 0) return {{kTripped, TripCause::kStopTimeout}, refusal};
      return go(kStopping, refusal);
    }
    case kDisarming: {
      const bool off = facts.drives_off != 0 || facts.stop_expired != 0;
      return go(off ? kIdle : kDisarming,
                request == RequestKind::kDisarm ? Refusal::kNone : not_here);
    }
    case kFaultStopping:
    case kTripped:
      break;  // handled above
  }
  return {{kTripped, TripCause::kStateNotFinite}, not_here};
}

const char* ToString(RequestKind request) noexcept;

/// Machine name of a refusal, as in JSON: "wrong-state".
const char* ToString(Refusal refusal) noexcept;

/// Text for the operator: why the request was refused in `state` and what to do. "" if accepted.
const char* RefusalText(RequestKind request, Refusal refusal, SafetyState state) noexcept;

}  // namespace flexarm
