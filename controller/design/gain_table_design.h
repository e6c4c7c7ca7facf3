#pragma once

#include <array>

#include "controller/law/gain_table.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// Cost weights for the gains of a table. The design study's values: docs/theory/payload.md 4.2.
struct GainWeights {
  std::array<double, 12>
      state;           ///< diagonal of Q on [q; q'] of RigidJointArm, 1 over their squares
  double torque;       ///< R = rho I, 1/(N m)^2
  double alpha_per_s;  ///< prescribed degree of stability, >= 0
};

/// Gain scheduling: a discrete LQR with degree of stability alpha at every knot, arm at rest and
/// straight.
///
/// Takes about a millisecond per knot. Source: docs/theory/payload.md 4.2, control-law.md 3.1.
/// @param period_s  > 0
/// @throws std::invalid_argument as GainTable; std::runtime_error if a knot has no solution
GainTable DesignGainTable(const RigidJointArm& arm, const GainGrid& grid,
                          const GainWeights& weights, double period_s);

}  // namespace flexarm
