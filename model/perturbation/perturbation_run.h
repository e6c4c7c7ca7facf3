#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "model/arm/arm_model.h"

namespace flexarm {

/// Linearised against nonlinear arm about one motion (thesis 6.2, figures 6.1 and 6.2).
struct PerturbationRun {
  std::vector<double> time_s;
  std::vector<Eigen::VectorXd> nominal;    ///< q of the nominal motion
  std::vector<Eigen::VectorXd> nonlinear;  ///< q of the perturbed motion minus the nominal one
  std::vector<Eigen::VectorXd> linear;  ///< the same by the linear model along the nominal motion

  /// Largest difference of coordinate i between the two, over the largest deviation.
  double RelativeError(Eigen::Index i) const;
};

/// Torques on th3 and th4 as a function of time, N m: input of a perturbation test.
using TorqueAt = std::function<Eigen::Vector2d(double time_s)>;

/// Simulates the arm without friction from (q, v) with `nominal` torques and with
/// `nominal + delta`, and the linear model along the nominal motion (6.4) with `delta` alone:
/// implicit midpoint for all three, so that they differ only by the neglected higher orders.
/// @throws std::invalid_argument if the step or the duration is not positive, or the arm has more
/// modes than ArmSimulator supports.
PerturbationRun Perturb(const ArmModel& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                        const TorqueAt& nominal, const TorqueAt& delta, double duration_s,
                        double step_s);

}  // namespace flexarm
