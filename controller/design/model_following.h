#pragma once

#include <vector>

#include "controller/types/control_config.h"

namespace flexarm {

/// Ranks of the condition for perfect model following, (7.3): rank B = rank [B, A - A_m]. The
/// thesis does not print the condition on the inputs, rank B = rank [B, B_m].
struct FollowingRanks {
  int input;       ///< rank B
  int difference;  ///< rank [B, A - A_m]
  int reference;   ///< rank [B, B_m]

  bool follows() const { return difference == input && reference == input; }
};

/// What the plant matrix A_p of (7.1) contains, beside elastic links and joints.
struct FollowingPlant {
  double friction_gain_s_per_rad = 0.0;  ///< k of K_F tanh(k th'), linearised at rest; 0: none
  bool in_clearance = false;             ///< backlash: joint 2's gears touch nowhere, K_2 = 0
  bool damping_of_reference = false;     ///< links damped as those of the reference model
};

/// (7.3) with the nominal model of a config as (7.1) and its reference model as (7.2).
/// Source: thesis 7.2 d.
/// Ranks in balanced coordinates, singular values above 1e-9 of the largest; they are 5e-4 or
/// 1e-16 here.
struct ModelFollowing {
  FollowingRanks continuous;
  FollowingRanks discrete;  ///< both by zero-order hold over the loop's period
};

/// @param layout  of the nominal model, if not that of the config
ModelFollowing TestModelFollowing(const ControlConfig& config, const StateLayout& layout,
                                  const FollowingPlant& plant = {});

}  // namespace flexarm
