#pragma once

#include <array>
#include <cstdint>

#include "controller/types/loop_grid.h"
#include "controller/types/safety_config.h"
#include "controller/types/safety_state.h"

namespace flexarm {

/// Age at `now_ns` of a value valid since `since_ns`; INT64_MAX for "never" (INT64_MIN).
constexpr std::int64_t AgeNs(std::int64_t now_ns, std::int64_t since_ns) noexcept {
  return since_ns == INT64_MIN ? INT64_MAX : now_ns - since_ns;
}

/// Limits of the torque gate.
struct GateLimits {
  std::array<double, 2> torque_nm;
  std::array<double, 2> slew_nm_per_s;
  std::int64_t command_timeout_ns;  ///< two control periods
  std::int64_t permit_timeout_ns;   ///< safety.permit_timeout_ms
  double homing_fraction;           ///< safety.homing_torque_fraction
  double reduced_fraction;          ///< safety.reduced_torque
};

/// The limits of a rig.
GateLimits MakeGateLimits(const SafetyConfig& safety, const LoopGrid& grid) noexcept;

struct GateInput {
  std::array<double, 2> asked_nm;     ///< requested torque: the newest command that acts
  std::int64_t asked_age_ns;          ///< since it began to act (AgeNs)
  SafetyState permit;                 ///< newest permit
  bool homing;                        ///< its run is homing (Homes): less torque
  bool reduced;                       ///< its limits are reduced: the same
  std::int64_t permit_age_ns;         ///< since it was renewed (AgeNs)
  std::array<double, 2> previous_nm;  ///< last output of the gate
  double dt_s;                        ///< since then
};

/// Why the gate changed the requested torque. The first four: zero on both joints, at once.
enum GateBit : std::uint32_t {
  kGateCommandOld = 1,
  kGatePermitOld = 2,
  kGateNotAllowed = 4,
  kGateNotFinite = 8,
  kGateTorque1 = 16,
  kGateTorque2 = 32,
  kGateSlew1 = 64,
  kGateSlew2 = 128,
};
inline constexpr std::uint32_t kGateZeroed =
    kGateCommandOld | kGatePermitOld | kGateNotAllowed | kGateNotFinite;

/// A GateBit and its name for people and JSON.
struct GateReason {
  GateBit bit;
  const char* name;
};
inline constexpr std::array<GateReason, 8> kGateReasons = {{{kGateCommandOld, "command-old"},
                                                            {kGatePermitOld, "permit-old"},
                                                            {kGateNotAllowed, "not-allowed"},
                                                            {kGateNotFinite, "not-finite"},
                                                            {kGateTorque1, "torque-limit-1"},
                                                            {kGateTorque2, "torque-limit-2"},
                                                            {kGateSlew1, "slew-limit-1"},
                                                            {kGateSlew2, "slew-limit-2"}}};

struct GateResult {
  std::array<double, 2> torque_nm;
  std::uint32_t why;  ///< GateBit; 0: unchanged
};

/// Torque gate, the last step before a drive: passes a torque only if the command and the permit
/// are recent, the state allows torque and all values are finite; then limits torque and slew rate.
///
/// |out| <= torque limit always, |out - previous| <= slew limit * dt unless zeroed (up to
/// rounding). A negative age is a clock error and counts as old. Real-time: safe.  Thread:
/// the one that writes the drive.
[[nodiscard]] GateResult Gate(const GateInput& in, const GateLimits& limits) noexcept;

}  // namespace flexarm
