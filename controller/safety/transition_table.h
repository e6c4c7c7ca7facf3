#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "controller/safety/safety_machine.h"

namespace flexarm {

/// A row of transition_table.def.
struct TableRow {
  std::string_view from;  ///< "Armed", or "Corrupted"
  std::string_view when;  ///< condition, as written there
  std::string_view to;    ///< state of a transition; reason of a refusal: "None" accepts
};

/// The specification of the safety state machine, row by row. NextSafetyState does not use it.
inline constexpr std::size_t kTransitions = std::to_array({
#define TRANSITION(from, when, to, cause) 0,
#include "controller/safety/transition_table.def"
                                                          })
                                                .size();
inline constexpr std::size_t kRefusals = std::to_array({
#define REFUSAL(in, when, why) 0,
#include "controller/safety/transition_table.def"
                                                       })
                                             .size();

extern const std::array<TableRow, kTransitions> kTransitionRows;
extern const std::array<TableRow, kRefusals> kRefusalRows;

/// What the table requires of one tick.
struct TableVerdict {
  SafetyDecision decision;
  std::size_t transition;  ///< index of the row that holds; kTransitions: none, the state stays
  std::size_t refusal;     ///< the same of the answer; kRefusals: none
  std::size_t transitions_held;  ///< rows that hold: more than one is an error of the table
  std::size_t refusals_held;     ///< the same of the answers
};

/// Applies the table. Off line: for checks and tests.
TableVerdict ApplyTable(const SafetyStatus& status, const SafetyFacts& facts) noexcept;

}  // namespace flexarm
