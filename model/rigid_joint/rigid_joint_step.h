#pragma once

#include <Eigen/Core>
#include <array>

#include "model/math/lanes.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// Motion of the arm with rigid joints and of the analogue filters of its strain gauges. Scalar:
/// double, or Lanes for four cases.
template <typename Scalar>
struct GaugedStateOf {
  RigidJointArm::VectorOf<Scalar> q, v;  ///< as RigidJointArm's, rad and m, and their rates
  Eigen::Matrix<Scalar, 4, 1> phi_f;  ///< filtered modal coordinates, phi_f' = w_f (phi - phi_f), m
};
using GaugedState = GaugedStateOf<double>;

/// Inputs that are constant during a sample.
template <typename Scalar>
struct SampleInputsOf {
  Eigen::Vector2d torque_nm;
  Scalar payload_kg;
  std::array<Scalar, 2> friction_nm;  ///< Coulomb levels of the hubs, >= 0
};
using SampleInputs = SampleInputsOf<double>;

/// Integrates one sample of the arm with exact Coulomb stiction: a few implicit midpoint steps of
/// kPasses fixed-point passes each.
///
/// As ArmSimulator (hubs by CoulombFrictionLcp at the midpoint velocity), in longer steps, and for
/// a payload that may differ from sample to sample. The passes of a step start from zero
/// acceleration. The gauges' filters are driven by the modal coordinates of the middle of each
/// step.
/// Source: docs/theory/payload.md 1.
/// Real-time: Advance is safe.
class RigidJointStepper {
 public:
  static constexpr int kSteps = 8;  ///< used by PayloadFilter
  static constexpr int kPasses = 2;

  /// @param period_s         one sample, > 0
  /// @param gauge_filter_hz  corner of the gauges' first-order filter, > 0
  /// @param steps            a power of two, for TransitionOver's doublings
  RigidJointStepper(RigidJointArm arm, double period_s, double gauge_filter_hz, int steps = kSteps);

  /// As RigidJointArm::Constants, with the constants of the sample.
  std::vector<double> Constants() const;
  /// @throws std::invalid_argument if their number differs from that of Constants()
  explicit RigidJointStepper(std::span<const double> constants);

  /// One sample.
  GaugedState Advance(const GaugedState& start, const SampleInputs& inputs) const noexcept {
    return Advance(start, inputs, steps_);
  }
  /// @param steps  of step_s() each
  GaugedState Advance(const GaugedState& start, const SampleInputs& inputs,
                      int steps) const noexcept;
  /// The same for four cases; each gets the bits that it would get alone.
  GaugedStateOf<Lanes> AdvanceFour(const GaugedStateOf<Lanes>& start,
                                   const SampleInputsOf<Lanes>& inputs, int steps) const noexcept;

  /// Accelerations at this state, rad/s^2 and m/s^2. A hub that friction can stop within a step is
  /// decelerated to rest; a hub at rest remains so.
  RigidJointArm::Vector AccelerationAt(const GaugedState& x,
                                       const SampleInputs& inputs) const noexcept;

  const RigidJointArm& arm() const noexcept { return arm_; }
  int steps() const noexcept { return steps_; }
  double period_s() const noexcept { return steps_ * h_; }
  double step_s() const noexcept { return h_; }
  /// Part of a gauge filter's error that one step removes.
  double gauge_share() const noexcept { return gauge_share_; }

 private:
  template <typename Scalar>
  GaugedStateOf<Scalar> AdvanceOf(const GaugedStateOf<Scalar>& start,
                                  const SampleInputsOf<Scalar>& inputs, int steps) const noexcept;
  template <typename Scalar>
  RigidJointArm::VectorOf<Scalar> Solve(const RigidJointArm::MatrixOf<Scalar>& A,
                                        const RigidJointArm::VectorOf<Scalar>& r,
                                        const RigidJointArm::VectorOf<Scalar>& v,
                                        const std::array<Scalar, 2>& friction_nm) const noexcept;
  template <typename Scalar>
  RigidJointArm::VectorOf<Scalar> Acceleration(
      const OutboardBodyOf<Scalar>& body, const GaugedStateOf<Scalar>& start,
      const RigidJointArm::VectorOf<Scalar>& applied,
      const std::array<Scalar, 2>& friction_nm) const noexcept;

  static RigidJointArm::Matrix Implicit(const RigidJointArm& arm, double h) {
    return 0.5 * h * arm.damping() + 0.25 * h * h * arm.stiffness();
  }

  RigidJointArm arm_;
  int steps_;
  double h_;
  double gauge_share_;
  RigidJointArm::Matrix implicit_;  // h/2 D + h^2/4 K
};

}  // namespace flexarm
