#pragma once

#include <vector>

#include "controller/types/experiment.h"

namespace flexarm {

/// Angles of a chirp of amplitude 1, one a period, 0 at both ends.
///
///   y(t) = w(t) sin(2 pi (f1 t + (f2 - f1) t^2 / (2 T))),  w rises and falls by a quintic over the
/// first and last tenth of T: a double integrator led along y ends at rest where it began.
/// @param n  periods, T = n Ts
std::vector<double> ChirpAngles(const Chirp& chirp, int n, double period_s);

/// One period of a maximal-length sequence as +1 and -1: 2^bits - 1 values.
///
/// Fibonacci shift register with a primitive polynomial. The circular autocorrelation is 2^bits - 1
/// at shift 0 and -1 at every other: a flat spectrum.
/// @param bits  2 .. 12
/// @param seed  1 .. 2^bits - 1: another seed is the same sequence shifted
std::vector<int> MaximalLengthSequence(int bits, int seed);

/// Torque signs of one joint, one a period: each value of the sequence as the pulse (+, -, -, +).
///
/// Every pulse has no area and no first moment, so that inertias end at rest where they began.
/// Joint 2 plays the sequence from its middle, so that the joints' torques are hardly correlated.
/// @param hold_periods  length of each of the four parts
/// @param joint  0 or 1
std::vector<double> PrbsSigns(const Prbs& prbs, int hold_periods, int joint);

}  // namespace flexarm
