#pragma once

#include <cstdint>

#include "controller/types/messages.h"
#include "controller/types/records.h"

namespace flexarm {

/// What the operator task has read from the loop in the current period.
struct OperatorSnapshot {
  std::int64_t now_ns = 0;     ///< due instant of the period, in the clock of the loop
  Permit permit{};             ///< that holds just before that instant
  TickRecord tick{};           ///< the newest sample; zero before the first one
  bool shutting_down = false;  ///< the daemon ends: only status, stop and disarm are accepted
};

}  // namespace flexarm
