#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "model/arm/arm_model.h"
#include "tools/bench_host/plant_rate.h"

namespace flexarm {

/// The motion on which solvers are compared: from rest, a second long, both joints pushed one way
/// for half of it and back for the other, at a share of the torque limits that turns the shipped
/// arm by some 15 deg. The equations are those of PlantRate.
class SolverProblem {
 public:
  static constexpr std::size_t kInstants = 20;  ///< at which solutions are compared
  static constexpr double kInterval_s = 0.05;   ///< between them
  static constexpr std::size_t kStates = 2 * static_cast<std::size_t>(PlantRate::kDof);
  using State = std::array<double, kStates>;
  /// A solution: y after each interval, kInstants of them.
  using Motion = std::vector<State>;

  /// @param arm              SmoothArm is made of it
  /// @param torque_limit_nm  safety.torque_limit_nm
  SolverProblem(const ArmParameters& arm, const std::array<double, 2>& torque_limit_nm);

  const ArmModel& model() const noexcept { return model_; }
  /// Torques on th3 and th4 in the interval that ends at an instant, N m.
  Eigen::Vector2d PushBefore(std::size_t instant) const noexcept;

  /// By ArmSimulator. @param step_s  a whole number of them makes kInterval_s
  Motion ByPlant(double step_s) const;
  /// By the classical Runge-Kutta method of order 4.
  Motion ByRungeKutta(double step_s) const;

  /// Largest distance between the tips of two solutions at any instant, m; NaN if one is not
  /// finite.
  double TipError_m(const Motion& a, const Motion& b) const;

 private:
  ArmModel model_;
  Eigen::Vector2d push_nm_;
};

/// A solution that is far more accurate than those that are compared with it.
struct SolverReference {
  SolverProblem::Motion motion;
  double error_m;  ///< distance from the solution with half its step
};
SolverReference MakeReference(const SolverProblem& problem);

}  // namespace flexarm
