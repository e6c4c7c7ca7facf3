#pragma once

#include <Eigen/Core>

#include "model/rigid_joint/rigid_joint_transition.h"

namespace flexarm {

/// Covariance P of the states of PayloadFilter, and what a sample does to it.
///
/// 16 states of the motion (q, q', phi_f), the payload, the Coulomb levels of the two hubs. A last
/// row and column of zeros makes columns whole pairs of numbers (ColumnSum). P is symmetric to the
/// bit. Source: docs/theory/payload.md 2.2, 2.5. Real-time: safe.
struct PayloadCovariance {
  static constexpr int kMotion = Transition::kStates;
  static constexpr int kPayload = kMotion;
  static constexpr int kFriction = kMotion + 1;
  static constexpr int kStates = kMotion + 3;
  static constexpr int kPadded = kStates + 1;

  using Matrix = Eigen::Matrix<double, kPadded, kPadded>;
  using Vector = Eigen::Matrix<double, kPadded, 1>;  ///< a change of the states; last: 0
  template <int kOutputs>
  using ByOutput = Eigen::Matrix<double, kPadded, kOutputs>;

  /// What the motion becomes over a sample: dx <- F dx. Payload and friction stay.
  struct Change {
    static constexpr int kDriving = 15;  ///< states that drive others: all but phi_f
    Eigen::Matrix<double, kMotion, kDriving> by_driving;  ///< q, q', payload, friction
    double gauge_kept;                                    ///< phi_f by itself

    Vector Of(const Vector& dx) const noexcept;
  };

  /// P <- F P F' + N N' for the motion and what it has in common with payload and friction.
  /// @param N  16 x 6, process noise
  static void Propagate(const Change& change,
                        const Eigen::Matrix<double, kMotion, RigidJointArm::kDof>& N,
                        Matrix* P) noexcept;

  /// P <- P - V V', but the last `frozen` states (0, 1 or 3) keep their own block.
  ///
  /// With V = P H' L'^-1 and L L' = H P H' + R, this is the covariance after an update by the gain
  /// V L^-1 with zero rows for those states. Joseph's form with that gain gives the same.
  /// @param frozen  0; 1: the payload; 3: friction, too
  static void Reduce(const ByOutput<8>& V, int frozen, Matrix* P) noexcept;
  static void Reduce(const ByOutput<1>& V, int frozen, Matrix* P) noexcept;
};

}  // namespace flexarm
