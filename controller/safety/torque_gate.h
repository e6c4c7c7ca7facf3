#pragma once

#include <array>
#include <cstdint>

#include "controller/types/loop_grid.h"
#include "controller/types/safety_config.h"
#include "controller/types/safety_state.h"

namespace flexarm {

/// Age at `now_ns` of what holds since `since_ns`; INT64_MAX for "never" (INT64_MIN).
constexpr std::int64_t AgeNs(std::int64_t now_ns, std::int64_t since_ns) noexcept {
  return since_ns == INT64_MIN ? INT64_MAX : now_ns - since_ns;
}

/// What the gate lets through at most.
struct GateLimits {
  std::array<double, 2> torque_nm;
  std::array<double, 2> slew_nm_per_s;
  std::int64_t command_timeout_ns;  ///< two control periods
  std::int64_t permit_timeout_ns;   ///< safety.permit_timeout_ms
};

/// The limits of a rig.
GateLimits MakeGateLimits(const SafetyConfig& safety, const LoopGrid& grid) noexcept;

struct GateInput {
  std::array<double, 2> asked_nm;     ///< newest command that acts
  std::int64_t asked_age_ns;          ///< since it acts (AgeNs)
  SafetyState permit;                 ///< newest permit
  std::int64_t permit_age_ns;         ///< since it was renewed (AgeNs)
  std::array<double, 2> previous_nm;  ///< what the gate let through last
  double dt_s;                        ///< since then
};

/// Why the gate changed what was asked. The first four: zero on both joints, at once.
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

struct GateResult {
  std::array<double, 2> torque_nm;
  std::uint32_t why;  ///< GateBit; 0: as asked
};

/// The last act before a drive: lets a torque through only if the command and the permit are young,
/// the state allows torque and all is finite; then within the torque limit and the slew limit.
///
/// |out| <= torque limit always, |out - previous| <= slew limit * dt unless zeroed (up to
/// rounding). An age below zero is a clock gone wrong, and counts as old. Real-time: safe.  Thread:
/// the one that writes the drive.
[[nodiscard]] GateResult Gate(const GateInput& in, const GateLimits& limits) noexcept;

}  // namespace flexarm
