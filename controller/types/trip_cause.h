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
  kEndedWhileArmed = 26,
  kTripRecordUnreadable = 27,
  kSafetyLines = 28,
  kSafetyOverrun = 29,
  kDeadlinesOftenMissed = 30,
  kBusUnreliable = 31,
  kBusTooSlow = 32,
  kShutdownTimeout = 33,
  kNoStrainReading1 = 34,
  kNoStrainReading2 = 35,
  kFollowingError1 = 36,
  kFollowingError2 = 37,
};
inline constexpr int kTripCauses = 38;

/// Set of causes, bit i is cause number i.
using TripCauses = std::uint64_t;

constexpr TripCauses CauseBit(TripCause cause) noexcept {
  return TripCauses{1} << static_cast<unsigned>(cause);
}

/// Causes of stop category 1: the arm moves too far, too fast or bends too much, while sensors and
/// drives are well. The controller damps it for a moment before the power goes (FaultStopping). All
/// others are of category 0: the torque is off in the same tick.
inline constexpr TripCauses kCategory1Causes =
    CauseBit(TripCause::kSoftLimit1) | CauseBit(TripCause::kSoftLimit2) |
    CauseBit(TripCause::kHubRate1) | CauseBit(TripCause::kHubRate2) |
    CauseBit(TripCause::kBendingStrain1) | CauseBit(TripCause::kBendingStrain2);

/// Whether the arm is damped when `causes` are present: at least one, all of category 1, and
/// `may_damp` (StepOutput::may_damp).
constexpr bool Damped(TripCauses causes, bool may_damp) noexcept {
  return causes != 0 && (causes & ~kCategory1Causes) == 0 && may_damp;
}

/// Short machine name, as in JSON and in the log: "limit-switch-1-low". "none" for kNone.
const char* ToString(TripCause cause) noexcept;

/// What Evidence::channel counts for a cause, 1-based.
enum class TripChannel : std::uint8_t { kNone, kJoint, kStrain, kCounter, kBus, kLineTrouble };

/// What is wrong with the lines of the safety chain: the channel of kSafetyLines. Logged: never
/// renumber.
enum class LineTrouble : std::uint8_t {
  kReadFailed = 1,
  kWriteFailed = 2,
  kReadSlow = 3,
  kWriteSlow = 4,
  kRelayStuckClosed = 5,
  kRelayStuckOpen = 6,
  kPumpStuckOn = 7,
  kVoltageMissing = 8,
  kVoltageStaysOn = 9,
  kVoltageUnknown = 10,
};
TripChannel ChannelOf(TripCause cause) noexcept;

/// Text for the operator: what happened, what it means, what to do.
const char* OperatorText(TripCause cause) noexcept;

}  // namespace flexarm
