#pragma once

#include <array>

#include "controller/exchange/latest_value.h"
#include "controller/types/messages.h"
#include "controller/types/trip_cause.h"

namespace flexarm {

/// Safety -> operator: what would trip now, each with the values that break its limit. A fault that
/// the loop has found is without values if the loop has found one of a lower number as well.
struct PresentCauses {
  TripCauses causes = 0;
  std::array<Evidence, kTripCauses> evidence{};  ///< by number of the cause
};
using PresentCausesChannel = LatestValue<PresentCauses>;

}  // namespace flexarm
