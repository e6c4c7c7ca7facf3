#include "tools/torture/detection.h"

#include <algorithm>
#include <initializer_list>

namespace flexarm {
namespace {

using enum TripCause;

constexpr TripCauses Set(std::initializer_list<TripCause> causes) {
  TripCauses set = 0;
  for (const TripCause cause : causes) set |= CauseBit(cause);
  return set;
}

constexpr TripCauses kGaugeCauses =
    Set({kStrainStuck, kStrainSaturated, kStrainOutOfFamily, kNoStrainReading1, kNoStrainReading2});
constexpr TripCauses kCounterCauses = Set({kEncoderJump, kHubAgainstRotor, kNoCounterReading});
constexpr TripCauses kBusCauses = Set({kStaleFrame, kBusLost, kBusUnreliable, kBusTooSlow});
constexpr TripCauses kSwitchCauses =
    Set({kLimitSwitch1Low, kLimitSwitch1High, kLimitSwitch2Low, kLimitSwitch2High, kEmergencyStop});

// What an arm that is led astray reaches: a limit, a switch, the end of the time for a stop, or a
// speed at which its encoders no longer agree with each other.
constexpr TripCauses kLimits = kCategory1Causes | kSwitchCauses |
                               Set({kEstimatorResidual, kStateNotFinite, kStopTimeout, kEncoderJump,
                                    kHubAgainstRotor, kFollowingError1, kFollowingError2});

}  // namespace

TripCauses NamesOf(const Fault& fault) {
  switch (fault.place) {
    case FaultPlace::kGauge:
    case FaultPlace::kGauges:
      return kGaugeCauses | kLimits;
    case FaultPlace::kCounter:
      return kCounterCauses | kLimits;
    case FaultPlace::kFrame:
      return kGaugeCauses | kCounterCauses | kBusCauses | kLimits;
    case FaultPlace::kTorque:
      return kLimits;
    case FaultPlace::kLine:
      // A limit switch that fails to open leaves the soft limits.
      return fault.index < 5 ? CauseBit(static_cast<TripCause>(fault.index + 1)) : 0;
    case FaultPlace::kLineReads:
    case FaultPlace::kLineWrites:
      return Set({kSafetyLines, kSafetyOverrun}) | kSwitchCauses | kLimits;
    case FaultPlace::kRelay:
    case FaultPlace::kPump:
      return Set({kSafetyLines, kDriveFault}) | kLimits;
    case FaultPlace::kBusReport:
      return kBusCauses | Set({kDriveFault});
    case FaultPlace::kDriveReport:
      return Set({kDriveFault});
    case FaultPlace::kSafety:
      return Set({kSafetyOverrun, kControlHeartbeatLost, kStaleFrame}) | kLimits;
    case FaultPlace::kControl:
      return Set({kMissedDeadlines, kControlHeartbeatLost, kDeadlinesOftenMissed}) | kLimits;
    case FaultPlace::kPlant:
      return kBusCauses | kGaugeCauses | kCounterCauses | kLimits;
    case FaultPlace::kOperator:
    case FaultPlace::kPlanner:  // the law has its closed form
      return 0;
  }
  return 0;
}

bool IsAbrupt(FaultKind kind) noexcept {
  return kind == FaultKind::kOff || kind == FaultKind::kNotANumber || kind == FaultKind::kGarbage ||
         kind == FaultKind::kWrongScale || kind == FaultKind::kStuck;
}

bool IsBridged(const Fault& fault) noexcept {
  return fault.place == FaultPlace::kGauge &&
         (fault.kind == FaultKind::kOff || fault.kind == FaultKind::kNotANumber);
}

bool IsAlone(const RigConfig& config, int counter) noexcept {
  return counter < 2 && (config.sensors.counters_present() >> (counter + 2) & 1U) == 0;
}

std::int64_t NamedWithinNs(const RigConfig& config, const Fault& fault) noexcept {
  if (!IsAbrupt(fault.kind) || IsBridged(fault)) return INT64_MAX;
  const std::int64_t ticks_ns = 3 * config.loop.period_ns();
  switch (fault.place) {
    case FaultPlace::kGauge:
    case FaultPlace::kCounter:
      return ticks_ns;
    case FaultPlace::kGauges:
    case FaultPlace::kFrame:
      // Readings that all repeat themselves, or have the same scale, agree with each other.
      return fault.kind == FaultKind::kStuck || fault.kind == FaultKind::kWrongScale ? INT64_MAX
                                                                                     : ticks_ns;
    case FaultPlace::kLine:
      // Two samples of 1 ms count. A closed switch that is stuck, and the button, are no danger.
      return fault.index < 5 && fault.kind != FaultKind::kStuck && fault.kind != FaultKind::kGarbage
                 ? 5 * kMs
                 : INT64_MAX;
    case FaultPlace::kLineReads:
      return 10 * kMs;
    case FaultPlace::kBusReport:
    case FaultPlace::kDriveReport:
    case FaultPlace::kControl:
    case FaultPlace::kPlant:
      return ticks_ns;
    case FaultPlace::kTorque:
    case FaultPlace::kLineWrites:
    case FaultPlace::kRelay:
    case FaultPlace::kPump:
    case FaultPlace::kSafety:
    case FaultPlace::kOperator:
    case FaultPlace::kPlanner:
      return INT64_MAX;
  }
  return INT64_MAX;
}

bool HideAngle(const RigConfig& config, const std::vector<Fault>& faults, int joint) noexcept {
  const auto any = [&faults](const auto& is) {
    return std::any_of(faults.begin(), faults.end(), is);
  };
  // Counters 0 and 1 are of the hubs, 2 and 3 of the rotors; lines 0 and 1 are the switches of
  // joint 0, 2 and 3 those of joint 1.
  const bool hub = any([joint](const Fault& fault) {
    return fault.place == FaultPlace::kCounter && fault.index == joint;
  });
  const bool rotor = any([joint](const Fault& fault) {
    return fault.place == FaultPlace::kCounter && fault.index == joint + 2;
  });
  const bool frame = any([&config](const Fault& fault) {
    return fault.place == FaultPlace::kFrame && NamedWithinNs(config, fault) == INT64_MAX;
  });
  const bool limit_switch = any([joint](const Fault& fault) {
    return fault.place == FaultPlace::kLine && fault.kind == FaultKind::kStuck &&
           fault.index / 2 == joint;
  });
  return limit_switch && (frame || (hub && rotor));
}

}  // namespace flexarm
