#pragma once

#include <array>
#include <vector>

#include "controller/law/design.h"
#include "controller/law/experiment.h"
#include "controller/law/step_types.h"

namespace flexarm {

/// The reference of one experiment, computed when it is accepted and never changed after.
///
/// Sample k holds at k Ts after the experiment's start; there is one more than the experiment has
/// periods, with u_m = 0: what comes after the end.
class ReferenceTable {
 public:
  /// Runs the reference model over the experiment's doublets and moves, from rest at `start_rad`.
  ///
  /// A doublet of amplitude a = M_r dtheta / d moves by dtheta, d the displacement of a unit
  /// inertia under the doublet's sampled shape (T^2/4 for a square, thesis 7.5). Its area is zero,
  /// so the reference model, a double integrator, ends at rest. A design with a shaper convolves
  /// all that with its weights: every move then ends as much later as the shaper is long.
  /// A move is u_m = M_r (to - from) times QuinticAccelerations: its rigid coordinates follow the
  /// profile and end exactly at the set-point.
  /// @throws Refused naming the doublet or move whose times do not lie on the grid of `period_s`,
  ///         or the instant at which the reference would leave +-`limit_rad`, or that the
  ///         shaped moves would end after the experiment
  ReferenceTable(const Experiment& experiment, const Design& design, double period_s,
                 const std::array<double, 2>& start_rad, const std::array<double, 2>& limit_rad);

  /// Torques without a reference model, for LoopMode::kOpenLoop.
  /// @param torque_nm  sample by sample, not empty; zero follows
  explicit ReferenceTable(const std::vector<std::array<double, 2>>& torque_nm);

  int periods() const noexcept { return static_cast<int>(samples_.size()) - 1; }

  /// Sample k; before 0 the rest at the start, after the end the last one. Real-time: safe.
  const ReferenceSample& At(int k) const noexcept;

 private:
  void Shape(const Eigen::RowVectorXd& shaper, double period_s);

  ReferenceSample rest_{};
  std::vector<ReferenceSample> samples_;
};

}  // namespace flexarm
