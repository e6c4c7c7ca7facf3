#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "controller/types/horizon_plan.h"
#include "model/rigid_joint/quasi_static_map.h"

namespace flexarm {

using PlanState = Eigen::Matrix<double, 12, 1>;

/// Planning problem: initial state, payload and path.
struct PlanProblem {
  std::int64_t first_tick;
  PlanState x;                       ///< at first_tick, [q; q'], rad and m, and per second
  double payload_kg;                 ///< as estimated now
  Eigen::Vector2d torque_before_nm;  ///< issued for the sample before first_tick, without friction
  /// The rigid coordinate, sample by sample from first_tick - 1: the size is the length of the
  /// horizon plus 3. docs/theory/payload.md 5.1: to 20 samples after the move's end.
  std::span<const RigidPoint> path;
  std::size_t move_samples;  ///< from first_tick to the end of the move
};

/// Weights of a plan's cost, 1 over squares of SI units. The design study's values:
/// docs/theory/payload.md 5.1.
struct PlanWeights {
  std::array<double, 12> moving;   ///< Q of a deviation from the reference, without payload
  std::array<double, 12> resting;  ///< Q from the end of the move on, for any payload
  std::array<double, 2> torque;    ///< R of a deviation from the quasi-static torque
  double light_kg;                 ///< Q during a move decreases as 1 / (1 + (payload / this)^2)
  double reference_payload_kg;     ///< reference: hub angles of an arm bent by this payload
};

/// A trajectory: stages + 1 states, stages torques. Large.
struct PlanTrajectory {
  std::array<PlanState, HorizonPlan::kMaxStages + 1> x;
  std::array<Eigen::Vector2d, HorizonPlan::kMaxStages> torque_nm;
};

/// Quadratic cost of a plan: deviations from a reference and from the quasi-static torque. Large.
///
///   J = sum over the stages of (x - r)'Q(x - r) + (u - u_ps)'R(u - u_ps), + (x - r)'Q(x - r)
///   at the horizon's end
///
/// r has the hub angles of the reference payload and straight links; x_ps, u_ps are those of
/// QuasiStaticAt with the present payload, u_ps at the instant of the sample. The weight at the end
/// and the instant of u_ps are choices of this program: they reproduce the plan of the design
/// study.
/// Source: docs/theory/payload.md 5.1. Real-time: safe.
class PlanCost {
 public:
  /// A path longer than HorizonPlan::kMaxStages is cut to that; a path too short for one stage
  /// gives zero stages.
  void Set(const RigidJointArm& arm, double period_s, const PlanWeights& weights,
           const PlanProblem& problem) noexcept;

  std::size_t stages() const noexcept { return stages_; }
  /// The quasi-static motion with the present payload.
  const PlanTrajectory& quasi_static() const noexcept { return quasi_static_; }
  const PlanState& Reference(std::size_t k) const noexcept { return reference_[k]; }

  /// Diagonal of Q of sample k.
  const PlanState& StateWeight(std::size_t k) const noexcept {
    return k < move_samples_ ? moving_ : resting_;
  }
  const Eigen::Vector2d& TorqueWeight() const noexcept { return torque_weight_; }

  double Cost(const PlanTrajectory& track) const noexcept;

 private:
  std::size_t stages_ = 0, move_samples_ = 0;
  PlanState moving_, resting_;
  Eigen::Vector2d torque_weight_;
  PlanTrajectory quasi_static_;
  std::array<PlanState, HorizonPlan::kMaxStages + 1> reference_;
};

}  // namespace flexarm
