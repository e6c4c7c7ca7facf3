#pragma once

#include <Eigen/Core>
#include <memory>

#include "model/arm/arm_model.h"

namespace flexarm {

/// Right-hand side of the plant as an ordinary differential equation, y' = f(y), y = [q; q'].
///
/// The arm of SmoothArm with the fast linear solver of ArmSimulator (ArticulatedArm with step 0),
/// so that a solver from elsewhere gets the equations as fast as ArmSimulator has them.
class PlantRate {
 public:
  static constexpr int kModes = 4;                             ///< on each link
  static constexpr int kDof = kRigidCoordinates + 2 * kModes;  ///< of q

  /// @param model  of SmoothArm with kModes modes on each link
  /// @throws std::invalid_argument for another number of modes
  explicit PlantRate(const ArmModel& model);
  ~PlantRate();
  PlantRate(const PlantRate&) = delete;
  PlantRate& operator=(const PlantRate&) = delete;

  /// Torques on th3 and th4 from now on, at the gearbox output.
  void Push(const Eigen::Vector2d& torque_nm) noexcept { torque_nm_ = torque_nm; }

  /// @param y      2 kDof: q in rad and m, q' in their rates
  /// @param y_dot  2 kDof, written; may not be y
  void operator()(const double* y, double* y_dot) const noexcept;

 private:
  struct Constants;
  std::unique_ptr<const Constants> constants_;
  Eigen::Vector2d torque_nm_ = Eigen::Vector2d::Zero();
};

/// The arm without what a general solver cannot take: dry friction and backlash; and without
/// foreshortening, for which ArmSimulator has another kernel.
ArmParameters SmoothArm(const ArmParameters& arm);

}  // namespace flexarm
