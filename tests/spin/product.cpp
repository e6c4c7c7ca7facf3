#include "tests/spin/product.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "controller/safety/safety_machine.h"
#include "tests/spin/numbers.h"  // macros: last

namespace {

// The numbers of the model are those of the product.
#define IS_STATE(name) static_assert((name) == static_cast<int>(flexarm::SafetyState::k##name))
IS_STATE(Starting);
IS_STATE(Idle);
IS_STATE(Armed);
IS_STATE(Running);
IS_STATE(Stopping);
IS_STATE(Tripped);
IS_STATE(FaultStopping);
IS_STATE(Disarming);
IS_STATE(TestingPump);
IS_STATE(TestingRelay);
IS_STATE(TestingPower);
static_assert(Corrupted == flexarm::kSafetyStates);

#define IS_REQUEST(name) \
  static_assert(Asks##name == static_cast<int>(flexarm::RequestKind::k##name))
IS_REQUEST(Arm);
IS_REQUEST(Run);
IS_REQUEST(Stop);
IS_REQUEST(Disarm);
IS_REQUEST(Reset);
IS_REQUEST(Change);

#define IS_REFUSAL(name) static_assert((name) == static_cast<int>(flexarm::Refusal::k##name))
IS_REFUSAL(None);
IS_REFUSAL(WrongState);
IS_REFUSAL(NotAtRest);
IS_REFUSAL(CauseRemains);
IS_REFUSAL(NoReset);
IS_REFUSAL(Unhealthy);
IS_REFUSAL(ShuttingDown);
IS_REFUSAL(DrivesOff);
IS_REFUSAL(RelayClosed);

#define IS_CAUSE(name) static_assert((name) == static_cast<int>(flexarm::TripCause::k##name))
IS_CAUSE(None);
IS_CAUSE(EmergencyStop);
IS_CAUSE(SoftLimit1);
IS_CAUSE(StateNotFinite);
IS_CAUSE(StopTimeout);
IS_CAUSE(EndedWhileArmed);
static_assert((flexarm::CauseBit(flexarm::TripCause::kSoftLimit1) & ~flexarm::kCategory1Causes) ==
              0);
#undef RelayClosed

// A number that depends on sequence, tick and use alone: SplitMix64, of Steele, Lea and Flood.
std::uint64_t Drawn(unsigned sequence, unsigned tick, unsigned use) {
  std::uint64_t z = (std::uint64_t{sequence} << 32) + (std::uint64_t{tick} << 8) + use;
  z = (z + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

int NumberInEnvironment(const char* name) {
  const char* text = std::getenv(name);
  return text == nullptr ? 0 : std::atoi(text);
}

struct RowsThatHeld {
  std::set<unsigned> rows;
  ~RowsThatHeld() {
    std::printf("rows that held:");
    for (const unsigned row : rows) std::printf(" %u", row);
    std::printf("\n");
  }
} rows_that_held;

}  // namespace

const int built_in = NumberInEnvironment("FLEXARM_ERROR");
const int has_witness = NumberInEnvironment("FLEXARM_WITNESS");

void row_held(unsigned row) { rows_that_held.rows.insert(row); }

unsigned product_next(unsigned state, unsigned cause, unsigned long long present, unsigned flags,
                      unsigned request) {
  const auto flag = [flags](unsigned bit) -> std::uint8_t { return (flags & bit) != 0 ? 1 : 0; };
  flexarm::SafetyFacts facts{};
  facts.present = present;
  facts.all_reported = flag(kFactReported);
  facts.at_rest = flag(kFactAtRest);
  facts.experiment_done = flag(kFactDone);
  facts.stop_expired = flag(kFactExpired);
  facts.reset_pressed = flag(kFactPressed);
  facts.shutting_down = flag(kFactShuttingDown);
  facts.may_damp = flag(kFactMayDamp);
  facts.drives_on = flag(kFactDrivesOn);
  facts.drives_off = flag(kFactDrivesOff);
  facts.tests_power = flag(kFactTestsPower);
  facts.power_follows = flag(kFactPowerFollows);
  facts.request = static_cast<flexarm::RequestKind>(request);
  const flexarm::SafetyDecision next = flexarm::NextSafetyState(
      {static_cast<flexarm::SafetyState>(state), static_cast<flexarm::TripCause>(cause)}, facts);
  return static_cast<unsigned>(next.status.state) +
         (static_cast<unsigned>(next.status.cause) << 8U) +
         (static_cast<unsigned>(next.refusal) << 16U);
}

unsigned product_relay(unsigned state) {
  return flexarm::RelayClosed(static_cast<flexarm::SafetyState>(state)) ? 1U : 0U;
}

unsigned product_pump(unsigned state) {
  return flexarm::PumpRuns(static_cast<flexarm::SafetyState>(state)) ? 1U : 0U;
}

unsigned product_torque(unsigned state) {
  return flexarm::TorqueAllowed(static_cast<flexarm::SafetyState>(state)) ? 1U : 0U;
}

unsigned lowest_cause(unsigned long long present) {
  for (unsigned number = 1; number < flexarm::kTripCauses; ++number) {
    if ((present >> number & 1U) != 0) return number;
  }
  return StateNotFinite;
}

unsigned all_of_category_1(unsigned long long present) {
  constexpr unsigned long long kNumbers6To11 = 0b111111ULL << 6U;  // docs/safety.md, "Causes"
  return present != 0 && (present & ~kNumbers6To11) == 0 ? 1U : 0U;
}

// A quarter of the ticks has causes, an eighth of them only of category 1; bit 0 is no cause.
unsigned long long sequence_present(unsigned sequence, unsigned tick) {
  const std::uint64_t drawn = Drawn(sequence, tick, 0);
  if (drawn % 8 == 0) return Drawn(sequence, tick, 1) & Drawn(sequence, tick, 2) & ~1ULL;
  return drawn % 8 == 1 ? Drawn(sequence, tick, 1) & flexarm::kCategory1Causes : 0;
}

// Half of the ticks are those of a healthy arm at rest, so that sequences go far.
unsigned sequence_flags(unsigned sequence, unsigned tick) {
  const std::uint64_t drawn = Drawn(sequence, tick, 3);
  const unsigned healthy =
      kFactReported | kFactAtRest | kFactPressed | kFactMayDamp | kFactDrivesOn | kFactPowerFollows;
  const unsigned set = static_cast<unsigned>(drawn >> 8U) & 2047U;
  const unsigned kept = drawn % 8 == 0 ? 2047U : ~static_cast<unsigned>(kFactShuttingDown);
  return (drawn % 2 == 0 ? set | healthy : set) & kept;
}

unsigned sequence_request(unsigned sequence, unsigned tick) {
  return static_cast<unsigned>(Drawn(sequence, tick, 4) % 8);
}
