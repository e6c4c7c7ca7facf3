#include "controller/safety/transition_table.h"

#include <algorithm>

namespace flexarm {
namespace {

// Which causes a row latches.
enum class Latched : std::uint8_t { kNone, kKept, kLowest, kStopTimeout, kStateNotFinite };

struct Held {
  std::array<bool, kTransitions> transitions;
  std::array<bool, kRefusals> refusals;
};

constexpr std::array<SafetyState, kTransitions> kTo{
#define TRANSITION(from, when, to, cause) SafetyState::k##to,
#include "controller/safety/transition_table.def"
};
constexpr std::array<Latched, kTransitions> kLatched{
#define TRANSITION(from, when, to, cause) Latched::k##cause,
#include "controller/safety/transition_table.def"
};
constexpr std::array<Refusal, kRefusals> kWhy{
#define REFUSAL(in, when, why) Refusal::k##why,
#include "controller/safety/transition_table.def"
};

bool IsCause(TripCause cause) noexcept {
  return cause != TripCause::kNone && static_cast<int>(cause) < kTripCauses;
}

// Every row, on its own. The names are those of the conditions.
Held RowsThatHold(const SafetyStatus& status, const SafetyFacts& facts) noexcept {
  using enum SafetyState;
  constexpr auto kCorrupted = static_cast<SafetyState>(kSafetyStates);
  const SafetyState state =
      static_cast<int>(status.state) < kSafetyStates ? status.state : kCorrupted;
  const bool cause_present = facts.present != 0;
  const bool all_damped = cause_present && (facts.present & ~kCategory1Causes) == 0;
  const bool cause_known = IsCause(status.cause);
  const bool all_reported = facts.all_reported != 0;
  const bool at_rest = facts.at_rest != 0;
  const bool experiment_done = facts.experiment_done != 0;
  const bool stop_expired = facts.stop_expired != 0;
  const bool reset_pressed = facts.reset_pressed != 0;
  const bool shutting_down = facts.shutting_down != 0;
  const bool may_damp = facts.may_damp != 0;
  const bool drives_on = facts.drives_on != 0;
  const bool drives_off = facts.drives_off != 0;
  const bool tests_power = facts.tests_power != 0;
  const bool power_follows = facts.power_follows != 0;
  const bool asks_any = facts.request != RequestKind::kNone;
  const bool asks_arm = facts.request == RequestKind::kArm;
  const bool asks_run = facts.request == RequestKind::kRun;
  const bool asks_stop = facts.request == RequestKind::kStop;
  const bool asks_disarm = facts.request == RequestKind::kDisarm;
  const bool asks_reset = facts.request == RequestKind::kReset;
  const bool asks_change = facts.request == RequestKind::kChange;
  return {.transitions =
              {
#define TRANSITION(from, when, to, cause) state == k##from && (when),
#include "controller/safety/transition_table.def"
              },
          .refusals = {
#define REFUSAL(in, when, why) state == k##in && (when),
#include "controller/safety/transition_table.def"
          }};
}

TripCause CauseOf(Latched latched, const SafetyStatus& status, const SafetyFacts& facts) noexcept {
  switch (latched) {
    case Latched::kNone:
      return TripCause::kNone;
    case Latched::kKept:
      return status.cause;
    case Latched::kStopTimeout:
      return TripCause::kStopTimeout;
    case Latched::kStateNotFinite:
      return TripCause::kStateNotFinite;
    case Latched::kLowest:
      break;
  }
  for (int number = 1; number < kTripCauses; ++number) {
    const auto cause = static_cast<TripCause>(number);
    if ((facts.present & CauseBit(cause)) != 0) return cause;
  }
  return TripCause::kStateNotFinite;
}

template <std::size_t kRows>
std::size_t First(const std::array<bool, kRows>& held) noexcept {
  return static_cast<std::size_t>(std::find(held.begin(), held.end(), true) - held.begin());
}

template <std::size_t kRows>
std::size_t Count(const std::array<bool, kRows>& held) noexcept {
  return static_cast<std::size_t>(std::count(held.begin(), held.end(), true));
}

}  // namespace

const std::array<TableRow, kTransitions> kTransitionRows{{
#define TRANSITION(from, when, to, cause) {#from, #when, #to},
#include "controller/safety/transition_table.def"
}};
const std::array<TableRow, kRefusals> kRefusalRows{{
#define REFUSAL(in, when, why) {#in, #when, #why},
#include "controller/safety/transition_table.def"
}};

TableVerdict ApplyTable(const SafetyStatus& status, const SafetyFacts& facts) noexcept {
  const Held held = RowsThatHold(status, facts);
  const std::size_t transition = First(held.transitions);
  const std::size_t refusal = First(held.refusals);
  const bool asked = facts.request != RequestKind::kNone;
  TableVerdict verdict{
      .decision = {.status = status, .refusal = asked ? Refusal::kWrongState : Refusal::kNone},
      .transition = transition,
      .refusal = refusal,
      .transitions_held = Count(held.transitions),
      .refusals_held = Count(held.refusals)};
  if (transition < kTransitions) {
    verdict.decision.status = {kTo[transition], CauseOf(kLatched[transition], status, facts)};
  }
  if (refusal < kRefusals) verdict.decision.refusal = kWhy[refusal];
  return verdict;
}

}  // namespace flexarm
