#include "controller/safety/torque_gate.h"

#include <algorithm>
#include <cmath>

namespace flexarm {
namespace {

bool Young(std::int64_t age_ns, std::int64_t timeout_ns) noexcept {
  return age_ns >= 0 && age_ns <= timeout_ns;
}

bool Finite(const std::array<double, 2>& values) noexcept {
  return std::isfinite(values[0]) && std::isfinite(values[1]);
}

}  // namespace

GateLimits MakeGateLimits(const SafetyConfig& safety, const LoopGrid& grid) noexcept {
  return {.torque_nm = safety.torque_limit_nm,
          .slew_nm_per_s = safety.slew_limit_nm_per_s,
          .command_timeout_ns = 2 * grid.period_ns,
          .permit_timeout_ns = std::llround(safety.permit_timeout_ms * 1e6),
          .homing_fraction = safety.homing_torque_fraction,
          .reduced_fraction = safety.reduced_torque};
}

GateResult Gate(const GateInput& in, const GateLimits& limits) noexcept {
  std::uint32_t why = 0;
  if (!Young(in.asked_age_ns, limits.command_timeout_ns)) why |= kGateCommandOld;
  if (!Young(in.permit_age_ns, limits.permit_timeout_ns)) why |= kGatePermitOld;
  if (!TorqueAllowed(in.permit)) why |= kGateNotAllowed;
  const bool finite = Finite(in.asked_nm) && Finite(in.previous_nm) && std::isfinite(in.dt_s) &&
                      Finite(limits.torque_nm) && Finite(limits.slew_nm_per_s) &&
                      std::isfinite(limits.homing_fraction) &&
                      std::isfinite(limits.reduced_fraction);
  if (!finite) why |= kGateNotFinite;
  if (why != 0) return {.torque_nm = {0.0, 0.0}, .why = why};

  double share = 1.0;
  if (in.homing) share = std::min(share, limits.homing_fraction);
  if (in.reduced) share = std::min(share, limits.reduced_fraction);
  GateResult result{.torque_nm = {0.0, 0.0}, .why = 0};
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const double limit = std::max(share * limits.torque_nm[joint], 0.0);
    const double step = std::max(limits.slew_nm_per_s[joint] * in.dt_s, 0.0);
    const double within = std::clamp(in.asked_nm[joint], -limit, limit);
    if (within != in.asked_nm[joint]) result.why |= joint == 0 ? kGateTorque1 : kGateTorque2;
    const double reached =
        std::clamp(within, in.previous_nm[joint] - step, in.previous_nm[joint] + step);
    if (reached != within) result.why |= joint == 0 ? kGateSlew1 : kGateSlew2;
    // The torque limit is applied last: `previous` may lie outside it.
    result.torque_nm[joint] = std::clamp(reached, -limit, limit);
  }
  return result;
}

}  // namespace flexarm
