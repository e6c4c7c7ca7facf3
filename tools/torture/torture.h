#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "controller/types/trip_cause.h"
#include "tools/torture/scenario.h"
#include "tools/torture/session_watch.h"
#include "tools/torture/torture_session.h"

namespace flexarm {

/// What became of a scenario.
struct TortureOutcome {
  std::vector<Violation> violations;
  bool reached = false;                           ///< the situation came about
  SafetyState began_in = SafetyState::kStarting;  ///< the state in which the faults began
  TripCause cause = TripCause::kNone;   ///< the first that latched after the faults had begun
  std::int64_t latched_ns = INT64_MAX;  ///< that instant, after the begin of the faults
  std::int64_t observable_ns =
      INT64_MAX;  ///< from then on a fault had to be seen; INT64_MAX: never
  Peaks peaks;    ///< from the begin of the faults until the end of the session
  std::vector<std::array<double, 2>> tip_m;  ///< of each millisecond after the faults began
  std::int64_t last_torque_ns = INT64_MIN;   ///< after the begin of the faults; INT64_MIN: none
  std::int64_t simulated_ns = 0;
  std::int64_t records = 0;  ///< steps that were replayed
};

/// Rigs by law, designed at their first use. Threads: any.
class TorturedRigs {
 public:
  /// @param with_law  the config with another law
  TorturedRigs(const std::function<RigConfig(const std::string& law)>& with_law,
               const std::vector<std::string>& laws);

  const TorturedRig& Of(const std::string& law) const { return rigs_.at(law); }

 private:
  std::map<std::string, TorturedRig> rigs_;
};

/// The envelopes: shares of the limits that the true arm may reach while a torque acts. The worst
/// of 400,000 sessions reached 1.24 times the angle, 2.40 times the rate and 1.05 times the strain;
/// a twentieth more of the angle, a quarter of the others (docs/torture.md).
inline constexpr Peaks kEnvelope{
    .torque_share = 1.0, .angle_share = 1.3, .rate_share = 3.0, .strain_share = 1.3};
/// The same of the angle if a torque is not that of the command: what damps the arm beyond its soft
/// limit may then drive it on, until FaultDetection::kDampedBeyond_deg, which is 1.5 times the
/// shipped limits, and in the two periods until the torque is off.
inline constexpr double kAngleShareWithTorqueFault = 2.0;
/// The same of the hub rate: of an arm whose elbow may turn five times as fast as its shoulder, the
/// elbow swings the shoulder.
inline constexpr double kRateShareWithTorqueFault = 4.0;

/// Runs one scenario and checks every rule (docs/torture.md).
/// @param guard  of the real-time tasks; null: none
TortureOutcome RunScenario(const TorturedRigs& rigs, const TortureScenario& scenario,
                           const Peaks& envelope = kEnvelope, ActivationGuard* guard = nullptr);

/// The longest time that a session is watched after its faults have begun.
inline constexpr std::int64_t kWatchedNs = 700 * kMs;

/// The smallest scenario found that breaks the same rule: fewer faults and commands, no disturbed
/// threads, the nominal arm, and shorter times until the faults and of each.
TortureScenario Minimised(const TorturedRigs& rigs, const TortureScenario& scenario,
                          const std::string& rule, const Peaks& envelope = kEnvelope);

}  // namespace flexarm
