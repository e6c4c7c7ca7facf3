#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "controller/types/step_types.h"
#include "estimator/payload_knowledge.h"
#include "estimator/state_estimate.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// Inputs of a control law, all at the instant at which its torque acts.
struct LawInput {
  const StateVector* x;                   ///< predicted state of the arm
  const ReferenceSample* reference;       ///< of the reference model
  const std::array<RigidPoint, 3>* path;  ///< one period before, at and after the instant
  const MotionSample* plan;               ///< null: no plan
  PayloadKnowledge payload;
  double rested_s;  ///< time since the last move ended; infinite before the first, 0 during one
  double settling_share;  ///< of the terms that bring the arm to rest, 0 to 1
  bool may_adapt;         ///< false: an input is invalid
};

/// Output of a control law.
struct LawOutput {
  std::array<double, 2> torque_nm;  ///< within the torque limits
  std::uint32_t limits;             ///< LimitBit
  bool finite;                      ///< false: the law's result was not finite; the torque is zero
  double lyapunov_nm2;              ///< V of (7.11) before this sample's adaptation; NaN: undefined
};

/// A control law: computes the torques on both hubs from state and reference, once a sample.
///
/// One object per controller.name, made by MakeLaw. Real-time: all but construction is safe.
/// Thread: the one that runs ControlStep::Step.
class Law {
 public:
  virtual ~Law() = default;

  /// Start of a run: resets the adaptation of earlier runs.
  virtual void Reset() noexcept = 0;
  virtual LawOutput Compute(const LawInput& input) noexcept = 0;

  /// Frobenius norm of the change of the adaptive gain since Reset; 0 without adaptive gain.
  virtual double adaptive_gain_change() const noexcept { return 0.0; }
};

/// Clips `u` to the torque limits. If `u` is not finite: zero, and `finite` is false.
LawOutput Saturate(const Eigen::Vector2d& u, const std::array<double, 2>& limit_nm) noexcept;

/// The same, and flags kAdaptationHeld: the law does not adapt to this torque.
LawOutput SaturateWithoutAdaptation(const Eigen::Vector2d& u,
                                    const std::array<double, 2>& limit_nm) noexcept;

}  // namespace flexarm
