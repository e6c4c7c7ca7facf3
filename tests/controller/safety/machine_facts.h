#pragma once

#include <cstdint>

#include "controller/safety/safety_machine.h"

// What the safety state machine is given, for its tests.
namespace flexarm {

inline constexpr auto kCorruptedState = static_cast<SafetyState>(kSafetyStates);
inline constexpr auto kCorruptedRequest = static_cast<RequestKind>(77);

constexpr SafetyStatus In(SafetyState state, TripCause cause = TripCause::kNone) {
  return {state, cause};
}

constexpr SafetyFacts Healthy(RequestKind request = RequestKind::kNone) {
  SafetyFacts facts{};
  facts.all_reported = 1;
  facts.at_rest = 1;
  facts.may_damp = 1;
  facts.drives_on = 1;
  facts.power_follows = 1;
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
  using enum SafetyState;
  if (state == kRunning || state == kStopping || state == kFaultStopping) return 2;
  const bool powered = state == kArmed || state == kDisarming || state == kTestingPower;
  return powered ? 1 : 0;
}

// Relay and charge pump, in this order, of each state: docs/safety.md, "States".
constexpr int Closed(SafetyState state) {
  using enum SafetyState;
  if (state == kTestingPump) return 0b01;
  if (state == kTestingRelay) return 0b10;
  return Energy(state) > 0 ? 0b11 : 0;
}

inline constexpr RequestKind kEveryRequest[] = {
    RequestKind::kNone,   RequestKind::kArm,   RequestKind::kRun,    RequestKind::kStop,
    RequestKind::kDisarm, RequestKind::kReset, RequestKind::kChange, kCorruptedRequest};

}  // namespace flexarm
