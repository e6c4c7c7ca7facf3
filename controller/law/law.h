#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "controller/types/step_types.h"
#include "estimator/payload_knowledge.h"
#include "estimator/state_estimate.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// What a control law may depend on, all of the instant at which its torque acts.
struct LawInput {
  const StateVector* x;                   ///< predicted state of the arm
  const ReferenceSample* reference;       ///< of the reference model
  const std::array<RigidPoint, 3>* path;  ///< one period before the instant, then, one after
  const PlanSample* plan;                 ///< null: there is none
  PayloadKnowledge payload;
  double rested_s;  ///< since the last move ended; infinite before the first, 0 during one
  bool may_adapt;   ///< false: an input is not good
};

/// What a control law asks for.
struct LawOutput {
  std::array<double, 2> torque_nm;  ///< within the torque limits
  std::uint32_t limits;             ///< LimitBit
  bool finite;                      ///< false: the law computed no number; the torque is zero
  double lyapunov_nm2;              ///< V of (7.11) before this sample's adaptation; NaN: has none
};

/// A control law: the torque on both hubs from state and reference, once a sample.
///
/// One object per controller.name, made by MakeLaw. Real-time: all but construction is safe.
/// Thread: the one that runs ControlStep::Step.
class Law {
 public:
  virtual ~Law() = default;

  /// A run begins: what the law learnt in an earlier one is forgotten.
  virtual void Reset() noexcept = 0;
  virtual LawOutput Compute(const LawInput& input) noexcept = 0;

  /// Frobenius norm of the change of the adaptive gain since Reset; 0 of a law that has none.
  virtual double adaptive_gain_change() const noexcept { return 0.0; }
};

/// `u` within the torque limits. Not finite: zero, and `finite` is false.
LawOutput Saturate(const Eigen::Vector2d& u, const std::array<double, 2>& limit_nm) noexcept;

/// The same for a torque that an adaptive law does not adapt to.
LawOutput SaturateWithoutAdaptation(const Eigen::Vector2d& u,
                                    const std::array<double, 2>& limit_nm) noexcept;

}  // namespace flexarm
