#pragma once

#include <Eigen/Core>

#include "model/arm/arm_model.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// Right-hand side of the plant as an ordinary differential equation, y' = f(y), y = [q; q'].
///
/// The acceleration is what one pass of ArmSimulator finds for a step of no time: its equations and
/// its linear solver, so that a solver from elsewhere gets them as fast as ArmSimulator has them.
class PlantRate {
 public:
  static constexpr int kModes = 4;                             ///< on each link
  static constexpr int kDof = kRigidCoordinates + 2 * kModes;  ///< of q

  /// @param model  of SmoothArm with kModes modes on each link
  /// @throws std::invalid_argument for another number of modes
  explicit PlantRate(const ArmModel& model);

  /// Torques on th3 and th4 from now on, at the gearbox output.
  void Push(const Eigen::Vector2d& torque_nm) noexcept { torque_nm_ = torque_nm; }

  /// @param y      2 kDof: q in rad and m, q' in their rates
  /// @param y_dot  2 kDof, written; may not be y
  void operator()(const double* y, double* y_dot) noexcept;

 private:
  ArmSimulator simulator_;
  ArmState state_;
  Eigen::Vector2d torque_nm_ = Eigen::Vector2d::Zero();
};

/// The arm without what a general solver cannot take: dry friction and backlash; and without
/// foreshortening, for which ArmSimulator has another kernel.
ArmParameters SmoothArm(const ArmParameters& arm);

}  // namespace flexarm
