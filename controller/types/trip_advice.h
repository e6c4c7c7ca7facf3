#pragma once

#include "controller/types/trip_cause.h"

namespace flexarm {

/// OperatorText in its parts, each one or more sentences.
struct TripAdvice {
  const char* happened;  ///< and what it means
  const char* check;     ///< how to find which of the causes it was
  const char* remedy;    ///< what to do, up to and including the reset where that is special
};

/// What follows the remedy of every trip.
inline constexpr const char* kAfterEveryTrip =
    "press the reset button for 50 ms, `flexarm reset`, `flexarm arm`";

/// Unit of value and limit of a cause (Evidence): "rad", "s", "exchanges"; "strain": without unit;
/// "level": of a digital input; "": they have no meaning.
const char* EvidenceUnit(TripCause cause) noexcept;

/// "" in each part for a number that is no cause.
TripAdvice AdviceOf(TripCause cause) noexcept;

}  // namespace flexarm
