#pragma once

#include <Eigen/Core>

#include "model/arm/arm_model.h"

namespace flexarm {

/// Explicit integrator of high order for the arm without friction: a reference for tests, not fast.
///
/// Gragg's modified midpoint rule with 2, 4, .. 2k substeps, extrapolated to step zero: order 2k.
/// It shares the equations with ArmSimulator but neither its linear solver nor its scheme.
/// Stable for about h * omega_max < k: with four columns h = 5e-4 s is sufficient up to 4 modes a
/// link. Source: Hairer, Norsett, Wanner, Solving ODEs I, section II.9. Real-time: start-up only
/// (allocates).
class ReferenceIntegrator {
 public:
  /// @param columns  k = 1..8; the default is of order 10
  /// @throws std::invalid_argument if it is outside.
  explicit ReferenceIntegrator(const ArmModel& model, int columns = 5);

  int order() const { return 2 * columns_; }

  /// Advances q and v by h_s with the motor torques held. Structural damping included.
  void Step(Eigen::VectorXd* q, Eigen::VectorXd* v, const Eigen::Vector2d& torque_nm,
            double h_s) const;

 private:
  const ArmModel* model_;
  int columns_;
};

}  // namespace flexarm
