#pragma once

#include <string>

#include "controller/types/messages.h"
#include "controller/types/trip_cause.h"

namespace flexarm {

/// What the latch file says: the arm has tripped, or was armed when the file was written. There is
/// no file while neither holds.
struct LatchRecord {
  TripCause cause = TripCause::kNone;  ///< kNone: armed, not tripped
  Evidence evidence{};                 ///< of the cause
  std::string time_utc;                ///< of the trip, or of the arming; ISO 8601
  std::string log_directory;           ///< where the logs of the runs are; for people only
};

/// The record as the JSON text of the file, version 1.
std::string LatchText(const LatchRecord& record);

/// @throws InputError naming what was found and what was expected: every text that LatchText cannot
///         have made, also one of another version or with an unknown cause
LatchRecord ParseLatch(const std::string& text);

}  // namespace flexarm
