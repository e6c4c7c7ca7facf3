#pragma once

#include <Eigen/Core>
#include <memory>

#include "model/arm/arm_constants.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// Fixed-point passes of a step: until two of them agree in the middle rates of th1, th2 and of
/// link 1's tip slope. Of an arm that swings violently they converge slowly, or not at all: then
/// the step is made as two of half the length.
struct Passes {
  int least, most;                ///< 1 <= least <= most
  double agreement_rad_s;         ///< no more passes below this difference
  double tolerated_rad_s;         ///< after `most` passes; above it up to `longest`
  int longest = 0, halvings = 0;  ///< the step is halved so often at most; then it stays as it is
};

/// Implicit midpoint steps for a fixed number of modes. Internal to ArmSimulator.
class StepKernel {
 public:
  virtual ~StepKernel() = default;
  virtual void Step(ArmState* state, const Eigen::Vector2d& torque_nm, double h_s,
                    const Passes& passes) noexcept = 0;
  /// Replaces the constants by those of the same arm with another payload.
  virtual void CarryPayload(const ArmConstants& constants) noexcept = 0;
};

/// The kernel compiled for max(m1, m2) modes per link. A link with fewer modes is padded with modes
/// of unit mass that are not excited.
std::unique_ptr<StepKernel> MakeStepKernel(const ArmConstants& constants, bool coulomb_friction);

/// The same for an arm with foreshortening; MakeStepKernel calls it.
std::unique_ptr<StepKernel> MakeForeshortenedKernel(const ArmConstants& constants,
                                                    bool coulomb_friction);

}  // namespace flexarm
