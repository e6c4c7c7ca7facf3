#pragma once

#include <Eigen/Core>

#include "model/arm_parameters.h"
#include "model/discretize.h"

namespace flexarm {

/// The linear model that estimator and controller are designed on: "R12" for two modes a link.
///
/// States [th1 th2 f11 f12 f21 f22 | rates], inputs tau1 tau2 (N m). Rigid joints (th3 = th1,
/// th4 = th2), straight arm, no friction: M q'' + D q' + K q = [I2; 0] u with M, D, K reduced from
/// the nonlinear arm by T_r. The free ends are so light that the torsion modes leave the band of a
/// 50 Hz loop (control.md section 2), so they are left out.
struct NominalModel {
  int modes_per_link;
  Eigen::MatrixXd M, D, K;            ///< n/2 x n/2
  Eigen::MatrixXd A, B;               ///< continuous, n x n and n x 2
  Eigen::VectorXd torque_mode_rad_s;  ///< undamped circular frequencies, non-zero, ascending

  int states() const { return static_cast<int>(A.rows()); }
};

/// Reduces the arm with `modes_per_link` modes at theta2 = 0, rest.
NominalModel MakeNominalModel(const ArmParameters& arm, int modes_per_link);

/// The reference model (control.md section 3): the same M and K, structural damping c_l G_l with
/// c_l = 2 / w_l ("coupled" critical damping), w_l the l-th torque mode.
NominalModel MakeReferenceModel(const NominalModel& nominal);

}  // namespace flexarm
