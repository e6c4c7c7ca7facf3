#pragma once

#include <cstdint>

namespace flexarm {

/// Causes of a trip. The numbers are logged and documented: never renumber.
enum class TripCause : std::uint8_t {
  kNone = 0,
  kLimitSwitch1Low = 1,
  kLimitSwitch1High = 2,
  kLimitSwitch2Low = 3,
  kLimitSwitch2High = 4,
  kEmergencyStop = 5,
  kSoftLimit1 = 6,
  kSoftLimit2 = 7,
  kHubRate1 = 8,
  kHubRate2 = 9,
  kBendingStrain1 = 10,
  kBendingStrain2 = 11,
  kEncoderJump = 12,
  kHubAgainstRotor = 13,
  kStrainStuck = 14,
  kStrainSaturated = 15,
  kStrainOutOfFamily = 16,
  kNoCounterReading = 17,
  kStaleFrame = 18,
  kBusLost = 19,
  kDriveFault = 20,
  kMissedDeadlines = 21,
  kControlHeartbeatLost = 22,
  kStateNotFinite = 23,
  kEstimatorResidual = 24,
  kStopTimeout = 25,
};
inline constexpr int kTripCauses = 26;

/// Set of causes, bit i is cause number i.
using TripCauses = std::uint64_t;

constexpr TripCauses CauseBit(TripCause cause) noexcept {
  return TripCauses{1} << static_cast<unsigned>(cause);
}

/// Short machine name, as in JSON and in the log: "limit-switch-1-low". "none" for kNone.
const char* ToString(TripCause cause) noexcept;

/// What Evidence::channel counts for a cause, 1-based.
enum class TripChannel : std::uint8_t { kNone, kJoint, kStrain, kCounter, kBus };
TripChannel ChannelOf(TripCause cause) noexcept;

/// Text for the operator: what happened, what it means, what to do.
const char* OperatorText(TripCause cause) noexcept;

}  // namespace flexarm
