#pragma once

#include <vector>

#include "controller/types/experiment.h"

namespace flexarm {

/// Angles of a chirp of amplitude 1, one per period, 0 at both ends.
///
///   y(t) = w(t) sin(2 pi (f1 t + (f2 - f1) t^2 / (2 T))),  w rises and falls by a quintic over the
/// first and last tenth of T: a double integrator that follows y ends at rest at its start.
/// @param n  periods, T = n Ts
std::vector<double> ChirpAngles(const Chirp& chirp, int n, double period_s);

/// One period of a maximal-length sequence as +1 and -1: 2^bits - 1 values.
///
/// Fibonacci shift register with a primitive polynomial. The circular autocorrelation is 2^bits - 1
/// at shift 0 and -1 at every other: a flat spectrum.
/// @param bits  2 .. 12
/// @param seed  1 .. 2^bits - 1: another seed gives the same sequence, shifted
std::vector<int> MaximalLengthSequence(int bits, int seed);

/// Torque signs of one joint, one per period: each value of the sequence becomes a pulse (+, -, -,
/// +).
///
/// Every pulse has zero area and zero first moment, so that inertias end at rest at their start.
/// Joint 2 starts the sequence at its middle, so that the joints' torques are hardly correlated.
/// @param hold_periods  length of each of the four parts
/// @param joint  0 or 1
std::vector<double> PrbsSigns(const Prbs& prbs, int hold_periods, int joint);

}  // namespace flexarm
