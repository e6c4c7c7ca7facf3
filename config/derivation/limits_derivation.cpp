#include <algorithm>
#include <cmath>

#include "config/derivation/derivation_parts.h"

namespace flexarm {
namespace {

using Pair = std::array<double, 2>;

// The longest step of the plant, at most 0.5 ms, that divides a millisecond and the period; 0.5 ms
// if none does, which the rules of the config refuse.
double PlantStep_ms(double period_ms) {
  constexpr int kMost = 20;  // in a millisecond
  for (int in_ms = 2; in_ms <= kMost; ++in_ms) {
    const double steps = period_ms * in_ms;
    if (std::abs(steps - std::nearbyint(steps)) < 1e-9 * steps) return 1.0 / in_ms;
  }
  return 0.5;
}

// A joint that is driven from rest by its whole torque turns one radian in sqrt(2 J / S).
double StopTimeout_s(const ArmScales& scales) {
  double slowest_s = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    slowest_s = std::max(slowest_s, std::sqrt(scales.inertia_kgm2[i] / scales.torque_nm[i]));
  }
  return std::clamp(8.0 * slowest_s, 4.0, 10.0);
}

}  // namespace

std::array<double, 2> HubRateLimit_rad_s(const ArmScales& scales) {
  Pair limit{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double reached = std::sqrt(scales.torque_nm[i] / scales.inertia_kgm2[i]);
    limit[i] = std::min(2.5 * reached, 0.65 * scales.ambiguous_rate_rad_s);
  }
  return limit;
}

void DeriveTiming(const TuningBasis& basis, DerivedList* out) {
  const double period_ms = 1e3 * basis.period_s;
  const double step_ms = PlantStep_ms(period_ms);
  out->Exact("sim.step_ms", step_ms, "at most 0.5 ms, a whole number of steps in a period");
  out->Exact("loop.acquire_before_ms", std::floor(0.5 * period_ms / step_ms) * step_ms,
             "half a period, in whole steps of the plant");
  out->Exact("loop.step_deadline_ms", 0.25 * period_ms, "a quarter of a period");
}

void DeriveLimits(const TuningBasis& basis, const ArmScales& scales, DerivedList* out) {
  Pair slew{}, pluck{};
  constexpr double kPulse_s = 0.4, kPluck_rad = 0.1;
  for (std::size_t i = 0; i < 2; ++i) {
    slew[i] = 0.4 * basis.torque_limit_nm[i] / basis.period_s;
    const double turn_nm = 4.0 * kPluck_rad * scales.inertia_kgm2[i] / (kPulse_s * kPulse_s);
    const double least_nm = 3.0 * basis.arm.joint[i].coulomb_friction_nm;
    pluck[i] = std::min(std::max(std::min(0.16 * scales.torque_nm[i], turn_nm), least_nm),
                        0.5 * scales.torque_nm[i]);
  }
  out->List("limits.slew_limit_nm_per_s", slew, "the torque limit in two and a half periods");
  out->List("limits.hub_rate_rad_s", HubRateLimit_rad_s(scales), "2.5 sqrt(S / J)");
  out->List("limits.strain_limit", scales.strain_limit,
            "0.95 of the strain that the gauges can show");
  out->Number("safety.stop_timeout_s", StopTimeout_s(scales),
              "8 sqrt(J / S) of the slower joint, 4 to 10 s");
  out->Number("safety.rest_strain_rate_per_s",
              2.6 * std::max(scales.strain_limit[0], scales.strain_limit[1]),
              "2.6 strain limits a second");
  out->List("commissioning.pluck_torque_nm", pluck,
            "turns the hub by 0.1 rad, at most 16 % of S, at least 3 F");
}

}  // namespace flexarm
