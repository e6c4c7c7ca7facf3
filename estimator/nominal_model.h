#pragma once

#include <Eigen/Core>

#include "estimator/state_layout.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// The linear model for the design of estimator and controller: "R12" and its variants.
///
/// Straight arm, no friction: M q'' + D q' + K q = E u, u = tau1 tau2 (N m) on the rotors, with M,
/// D, K reduced from the nonlinear arm by T_r. With rigid joints the rotors turn with their hubs:
/// the free ends are so light that the torsion modes lie above the band of a 50 Hz loop
/// (docs/theory/control-law.md 1.2). The thesis's own models have torsional joints: T12 with one
/// mode a link, T16 with two.
struct NominalModel {
  StateLayout layout;
  Eigen::MatrixXd M, D, K;            ///< n/2 x n/2
  Eigen::MatrixXd A, B;               ///< continuous, n x n and n x 2
  Eigen::VectorXd torque_mode_rad_s;  ///< undamped circular frequencies, non-zero, ascending

  /// M_r of the arm unbent and its joints untwisted, kg m^2: rigid-body motion has u = M_r th''.
  Eigen::Matrix2d RigidInertia_kgm2() const;
};

/// Reduces the arm at theta2 = 0, rest.
NominalModel MakeNominalModel(const ArmParameters& arm, const StateLayout& layout);

/// The reference model (docs/theory/control-law.md 2.1): the same M and K, structural damping c_l
/// G_l with c_l = 2 / w_l ("coupled" critical damping), w_l the l-th torque mode. Joints are
/// undamped.
NominalModel MakeReferenceModel(const NominalModel& nominal);

}  // namespace flexarm
