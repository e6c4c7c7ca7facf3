#pragma once

#include <vector>

#include "model/beam/beam_modes.h"

namespace flexarm {

/// Vibration of a link on a hub that is held by dry friction alone, at one amplitude.
struct FrictionRoot {
  bool sticks;               ///< the friction holds the root: the mode is the clamped one
  double frequency_rad_s;    ///< of that mode; between pinned and clamped if the root slips
  double clamped_moment_nm;  ///< |EI psi''(0)| a, the moment that a clamp would have to hold
};

/// The friction "switch" of thesis section 3.2, with the amplitude that it needs but omits.
///
/// (i) The clamped mode needs the moment |EI psi''(0)| a at its root, psi(L) = 1. (ii) Up to the
/// friction torque the root sticks. (iii) Above, the frequency is the one at which w(0) = 0, the
/// tip conditions, w(L) = a and |EI w''(0)| = T_f hold, on the branch from the pinned to the
/// clamped root of the same order (the pinned beam's rigid-body root is the first). The plant does
/// not use it: there friction is a generalised force (ArmSimulator).
/// @param order         mode, from 1
/// @param amplitude_m   a > 0: tip deflection
/// @param friction_nm   T_f >= 0
/// @throws std::invalid_argument if a bound is violated.
FrictionRoot FrictionRootMode(const std::vector<BeamSection>& section, const BeamTip& tip,
                              int order, double amplitude_m, double friction_nm);

}  // namespace flexarm
