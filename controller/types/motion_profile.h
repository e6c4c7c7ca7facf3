#pragma once

#include <cstdint>
#include <vector>

namespace flexarm {

/// Smooth profile from rest at 0 to rest at 1 over x = 0 .. 1.
enum class MoveProfile : std::uint8_t {
  kQuintic,  ///< s = 10 x^3 - 15 x^4 + 6 x^5: acceleration continuous, ends at 0
  kSeptic,   ///< s = 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7: the jerk is continuous as well
};

/// s(x) and its derivatives with respect to x; outside 0 .. 1 the profile rests at the nearer end.
struct ProfilePoint {
  double s, ds, dds, ddds;
};

/// Analytic. Peaks of ds and dds: 15/8 and 10/sqrt(3) (quintic), 35/16 and 84/(5 sqrt(5)) (septic).
/// Real-time: safe.
ProfilePoint ProfileAt(MoveProfile profile, double x) noexcept;

/// Smooth rest-to-rest motion by 1, as accelerations held for one period each, 1/s^2.
///
/// The profile is sampled at y_k = s(k / (n - 1)), k = 0 .. n - 1, and converted by
/// HeldAccelerations: after n periods a double integrator is at 1, at rest.
/// Peaks for large n, T = n Ts: those of ProfileAt over T and T^2.
/// @param n  periods, at least 3
std::vector<double> ProfileAccelerations(MoveProfile profile, int n, double period_s);

/// Accelerations that move a double integrator along `y`, from rest at 0 to rest at the last value.
///
/// a_k = (y_k+1 - 2 y_k + y_k-1) / Ts^2 with y = 0 before and the last value after, each held for
/// one period. At sample k the integrator is at (y_k + y_k-1) / 2: it starts and ends exactly,
/// without drift.
/// @param y  sample by sample, not empty; starts at or near 0
/// @returns  as many accelerations as samples
std::vector<double> HeldAccelerations(const std::vector<double>& y, double period_s);

}  // namespace flexarm
