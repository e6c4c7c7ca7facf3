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

/// What is to be planned.
struct PlanProblem {
  std::int64_t first_tick;
  PlanState x;                       ///< at first_tick, [q; q'], rad and m, and per second
  double payload_kg;                 ///< as estimated now
  Eigen::Vector2d torque_before_nm;  ///< issued for the sample before first_tick, without friction
  /// The rigid coordinate, sample by sample from first_tick - 1: its size is that of the horizon
  /// and 3 more. docs/theory/payload.md 5.1: to 20 samples after the move's end.
  std::span<const RigidPoint> path;
  std::size_t move_samples;  ///< from first_tick to the end of the move
};

/// Weights of a plan's cost, 1 by the squares of SI units. The design study's values:
/// docs/theory/payload.md 5.1.
struct PlanWeights {
  std::array<double, 12> moving;   ///< Q of a deviation from the reference, of an empty hand
  std::array<double, 12> resting;  ///< Q from the move's end on, whatever the payload
  std::array<double, 2> torque;    ///< R of a deviation from the quasi-static torque
  double light_kg;                 ///< Q while moving falls as 1 / (1 + (payload / this)^2)
  double reference_payload_kg;     ///< the reference: hubs of an arm bent with this payload
};

/// A trajectory: stages + 1 states, stages torques. Large.
struct PlanTrack {
  std::array<PlanState, HorizonPlan::kMaxStages + 1> x;
  std::array<Eigen::Vector2d, HorizonPlan::kMaxStages> torque_nm;
};

/// What a plan is drawn to, and what it costs to stay away. Large.
///
///   J = sum over the stages of (x - r)'Q(x - r) + (u - u_ps)'R(u - u_ps), + (x - r)'Q(x - r)
///   at the horizon's end
///
/// r has the hubs of the reference payload and straight links; x_ps, u_ps are those of
/// QuasiStaticAt with the present payload, u_ps at the instant of the sample. The weight at the end
/// and u_ps of the instant are this program's: with them the plan of the design study is
/// reproduced.
/// Source: docs/theory/payload.md 5.1. Real-time: safe.
class PlanCost {
 public:
  /// A path longer than HorizonPlan::kMaxStages is planned that far only; one too short for a stage
  /// gives none.
  void Set(const RigidJointArm& arm, double period_s, const PlanWeights& weights,
           const PlanProblem& problem) noexcept;

  std::size_t stages() const noexcept { return stages_; }
  /// The quasi-static motion with the present payload.
  const PlanTrack& quasi_static() const noexcept { return quasi_static_; }
  const PlanState& Reference(std::size_t k) const noexcept { return reference_[k]; }

  /// Diagonal of Q of sample k.
  const PlanState& StateWeight(std::size_t k) const noexcept {
    return k < move_samples_ ? moving_ : resting_;
  }
  const Eigen::Vector2d& TorqueWeight() const noexcept { return torque_weight_; }

  double Cost(const PlanTrack& track) const noexcept;

 private:
  std::size_t stages_ = 0, move_samples_ = 0;
  PlanState moving_, resting_;
  Eigen::Vector2d torque_weight_;
  PlanTrack quasi_static_;
  std::array<PlanState, HorizonPlan::kMaxStages + 1> reference_;
};

}  // namespace flexarm
