// NextSafetyState against its specification, transition_table.def, which shares no code with it.

#include "controller/safety/transition_table.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>
#include <vector>

namespace flexarm {
namespace {

std::string Describe(const SafetyStatus& status, const SafetyFacts& facts) {
  return std::string(ToString(status.state)) + " (" + ToString(status.cause) + "), request " +
         ToString(facts.request) + ", causes " + std::to_string(facts.present);
}

// Rows exclude each other, and the machine does what they say. @returns false after a failure
bool Agrees(const SafetyStatus& status, const SafetyFacts& facts, const TableVerdict& table) {
  const SafetyDecision machine = NextSafetyState(status, facts);
  EXPECT_LE(table.transitions_held, 1u) << Describe(status, facts);
  EXPECT_LE(table.refusals_held, 1u) << Describe(status, facts);
  EXPECT_EQ(ToString(table.decision.status.state), std::string(ToString(machine.status.state)))
      << Describe(status, facts);
  EXPECT_EQ(ToString(table.decision.status.cause), std::string(ToString(machine.status.cause)))
      << Describe(status, facts);
  EXPECT_EQ(ToString(table.decision.refusal), std::string(ToString(machine.refusal)))
      << Describe(status, facts);
  return !::testing::Test::HasFailure();
}

std::vector<SafetyStatus> EveryLatchedStatus() {
  std::vector<SafetyStatus> all;
  for (int state = 0; state <= kSafetyStates; ++state) {  // the last is none
    const auto of = static_cast<SafetyState>(state);
    if (!CauseLatched(of)) {
      all.push_back({of, TripCause::kNone});
      continue;
    }
    for (const int cause : {0, 1, 7, 19, kTripCauses - 1, kTripCauses}) {  // 0 and the last: none
      all.push_back({of, static_cast<TripCause>(cause)});
    }
  }
  all.push_back({static_cast<SafetyState>(255), TripCause::kNone});
  return all;
}

// Each cause alone and with the next one, none, and bits that are no cause.
std::vector<TripCauses> CauseSets() {
  std::vector<TripCauses> sets{0, TripCauses{1} << kTripCauses, TripCauses{1} << 63};
  for (int i = 1; i < kTripCauses; ++i) {
    sets.push_back(TripCauses{1} << i);
    sets.push_back((TripCauses{1} << i) | (TripCauses{1} << (i % (kTripCauses - 1) + 1)));
  }
  return sets;
}

constexpr unsigned kFlags = 11;

SafetyFacts FactsOf(TripCauses present, unsigned flags, RequestKind request) {
  const auto flag = [flags](unsigned bit) { return static_cast<std::uint8_t>(flags >> bit & 1u); };
  SafetyFacts facts{};
  facts.present = present;
  facts.all_reported = flag(0);
  facts.at_rest = flag(1);
  facts.experiment_done = flag(2);
  facts.stop_expired = flag(3);
  facts.reset_pressed = flag(4);
  facts.shutting_down = flag(5);
  facts.may_damp = flag(6);
  facts.drives_on = flag(7);
  facts.drives_off = flag(8);
  facts.tests_power = flag(9);
  facts.power_follows = flag(10);
  facts.request = request;
  return facts;
}

// 23 statuses x 73 sets of causes x 2048 flags x 8 requests: every case but for sets of three and
// more causes, which only their lowest number and category distinguish.
TEST(TransitionTable, TheMachineObeysItInEveryCase) {
  std::set<std::size_t> transitions;
  std::set<std::size_t> refusals;
  long cases = 0;
  for (const SafetyStatus& status : EveryLatchedStatus()) {
    for (const TripCauses present : CauseSets()) {
      for (unsigned flags = 0; flags < 1u << kFlags; ++flags) {
        for (const int request : {0, 1, 2, 3, 4, 5, 6, 77}) {
          const SafetyFacts facts = FactsOf(present, flags, static_cast<RequestKind>(request));
          const TableVerdict table = ApplyTable(status, facts);
          const bool same = table.decision == NextSafetyState(status, facts) &&
                            table.transitions_held == (table.transition < kTransitions ? 1U : 0U) &&
                            table.refusals_held == (table.refusal < kRefusals ? 1U : 0U);
          if (!same) {
            Agrees(status, facts, table);
            FAIL() << "in case " << cases;
          }
          transitions.insert(table.transition);
          refusals.insert(table.refusal);
          ++cases;
        }
      }
    }
  }
  EXPECT_EQ(cases, 23L * 77 * 2048 * 8);
  EXPECT_EQ(transitions.size(), kTransitions + 1) << "a row that never holds; and none";
  EXPECT_EQ(refusals.size(), kRefusals + 1) << "the same of the answers";
}

// Sets of any number of causes, without bit 0, which is no cause.
SafetyFacts RandomFacts(std::mt19937_64* random) {
  TripCauses present = 0;
  const std::uint64_t drawn = (*random)();
  if (drawn % 4 == 0) present = (*random)() & (*random)() & ~TripCauses{1};
  if (drawn % 8 == 1) present = kCategory1Causes & (*random)();
  const auto request = static_cast<RequestKind>((*random)() % 8);
  // Half of the facts are those of a healthy arm at rest, so that sequences go far.
  const bool healthy = drawn % 2 == 0;
  const unsigned flags = static_cast<unsigned>((*random)()) | (healthy ? 0b100'1101'0011u : 0u);
  return FactsOf(present, flags & ~(drawn % 8 == 0 ? 0u : 1u << 5), request);
}

// The same sequences of facts through both, each on its own status from Starting on: they stay
// together.
TEST(TransitionTable, MachineAndTableGiveTheSameStatesIn100000RandomSequences) {
  constexpr int kSequences = 100'000;
  constexpr int kTicks = 50;
  std::mt19937_64 random(20261126);
  std::array<int, kSafetyStates> reached{};
  for (int sequence = 0; sequence < kSequences; ++sequence) {
    SafetyStatus machine{SafetyState::kStarting, TripCause::kNone};
    SafetyStatus table = machine;
    for (int tick = 0; tick < kTicks; ++tick) {
      const SafetyFacts facts = RandomFacts(&random);
      const SafetyDecision of_machine = NextSafetyState(machine, facts);
      const SafetyDecision of_table = ApplyTable(table, facts).decision;
      ASSERT_TRUE(of_machine == of_table)
          << "sequence " << sequence << ", tick " << tick << ": " << Describe(machine, facts);
      machine = of_machine.status;
      table = of_table.status;
      ++reached[static_cast<std::size_t>(machine.state)];
    }
  }
  for (std::size_t state = 0; state < reached.size(); ++state) {
    EXPECT_GT(reached[state], kSequences / 1000)
        << "hardly ever in " << ToString(static_cast<SafetyState>(state));
  }
}

}  // namespace
}  // namespace flexarm
