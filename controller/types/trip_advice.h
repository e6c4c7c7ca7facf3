#pragma once

#include "controller/types/trip_cause.h"

namespace flexarm {

/// OperatorText in its parts, each one or more sentences.
struct TripAdvice {
  const char* happened;  ///< and what it means
  const char* check;     ///< how to find which of the causes it was
  const char* remedy;    ///< what to do, up to and including the reset where that is special
};

/// "" in each part for a number that is no cause.
TripAdvice AdviceOf(TripCause cause) noexcept;

}  // namespace flexarm
