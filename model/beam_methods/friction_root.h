#pragma once

#include <vector>

#include "model/beam/beam_modes.h"

namespace flexarm {

/// How a link rings on a hub that only dry friction holds, at one amplitude.
struct FrictionRoot {
  bool sticks;               ///< the friction holds the root: a clamped mode
  double frequency_rad_s;    ///< of that mode; between pinned and clamped if the root slips
  double clamped_moment_nm;  ///< |EI psi''(0)| a that a clamp would have to hold
};

/// The friction "switch" of thesis section 3.2, with the amplitude that it needs but does not name.
///
/// (i) The clamped mode asks its root for a moment |EI psi''(0)| a, psi(L) = 1. (ii) Up to the
/// friction torque the root sticks. (iii) Above, the frequency is the one at which w(0) = 0, the
/// tip conditions, w(L) = a and |EI w''(0)| = T_f hold, on the branch from the pinned to the
/// clamped root of the same order (the pinned beam's rigid-body root counts first). The plant does
/// not use it: there friction is a generalised force (ArmSimulator).
/// @param order         mode, from 1
/// @param amplitude_m   a > 0: tip deflection
/// @param friction_nm   T_f >= 0
/// @throws std::invalid_argument if a bound is broken.
FrictionRoot FrictionRootMode(const std::vector<BeamSection>& section, const BeamTip& tip,
                              int order, double amplitude_m, double friction_nm);

}  // namespace flexarm
