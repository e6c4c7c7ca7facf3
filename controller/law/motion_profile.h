#pragma once

#include <vector>

namespace flexarm {

/// Smooth rest-to-rest motion by 1, as accelerations that are held for one period each, 1/s^2.
///
/// s(x) = 10 x^3 - 15 x^4 + 6 x^5 is sampled at y_k = s(k / (n - 1)), k = 0 .. n - 1, and
/// a_k = (y_k+1 - 2 y_k + y_k-1) / Ts^2 with y = 0 before and 1 after. A discrete double integrator
/// driven by a_k stands at (y_k + y_k-1) / 2 at sample k: it leaves 0 at rest and is at 1 at rest
/// after n periods, without drift.
/// Peaks for large n, T = n Ts: rate 15/8 / T, acceleration 10/sqrt(3) / T^2.
/// @param n  periods, at least 3
std::vector<double> QuinticAccelerations(int n, double period_s);

}  // namespace flexarm
