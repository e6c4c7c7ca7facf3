#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "model/arm/arm_model.h"

namespace flexarm {

class StepKernel;

/// A vector of up to kMaxSteppedDof entries without heap memory.
using ArmVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxSteppedDof, 1>;

/// State of the simulated arm. q and v as ArmModel's.
struct ArmState {
  /// At rest at zero.
  /// @throws std::invalid_argument if dof is above kMaxSteppedDof.
  explicit ArmState(int dof);

  ArmVector q;  ///< rad and m
  ArmVector v;  ///< rad/s and m/s
  /// Accelerations of the last step, and of the one before it, rad/s^2 and m/s^2: only the start
  /// value of the next step's iteration, which is extrapolated from them; zero is always allowed.
  ArmVector a, a_before;
};

/// Number of passes and steps of ArmSimulator.
struct SimulatorOptions {
  /// Fixed-point passes a step, >= 1; without: 2 or more, until two of them agree.
  std::optional<int> passes = std::nullopt;
  int substeps = 1;  ///< equal midpoint steps per Step, >= 1
  bool coulomb_friction = true;
};

/// Time integrator of the arm: implicit midpoint with exact Coulomb stiction. The default one.
///
/// Solves M(q_m) a + bias(q_m, v_m) + D v_m + K q_m = force + friction at the middle of the step,
/// with (M + h/2 D + h^2/4 K) on the left, by fixed-point passes; they end when the rates at the
/// middle of the step agree to 1e-5 rad/s with those of the pass before; a step whose passes do not
/// converge is made as two of half the length. Friction torques on th1
/// and th2 (hub against its base) make a linear complementarity problem of two contacts that is
/// solved exactly in each pass (coulomb_friction_lcp.h). A hub that stops within a step ends it
/// with exactly zero velocity, by an impulse that only dissipates. Second order in h, stable for
/// any h.
///
/// The linear system is solved by structure (articulated bodies), not by a factorisation of M:
/// each link is coupled to the rest through three constant vectors only, so that a pass costs two
/// products with constant inverses and a 2x2 system.
/// Source: docs/theory/plant.md 7; thesis (3.12), (3.21)-(3.22).
/// Real-time: Step is safe (no allocation, no exception); construction is start-up only.
/// Thread: one at a time; a change of h recomputes cached inverses.
class ArmSimulator {
 public:
  static constexpr double kDefaultStep_s = 5e-4;

  /// @throws std::invalid_argument if an option is below its bound, or the model has a link
  /// with more than kMaxSteppedModes modes.
  explicit ArmSimulator(const ArmModel& model, const SimulatorOptions& options = {});
  ~ArmSimulator();
  ArmSimulator(ArmSimulator&&) noexcept;
  ArmSimulator& operator=(ArmSimulator&&) noexcept;

  int dof() const noexcept { return dof_; }

  /// Advances `state` by h_s with the motor torques held.
  /// @param state      of size dof(); updated in place
  /// @param torque_nm  on th3 and th4, at the gearbox output, N m
  /// @param h_s        > 0; useful range 1e-5 and less to 1e-3
  void Step(ArmState& state, const Eigen::Vector2d& torque_nm, double h_s) noexcept;

  /// Replaces the model by one that differs in its payload only. The state is kept
  /// (ArmModel::CarryPayload). Real-time: safe, costs about a Step.
  void CarryPayloadOf(const ArmModel& model) noexcept;

 private:
  int dof_;
  SimulatorOptions options_;
  std::unique_ptr<StepKernel> kernel_;
};

}  // namespace flexarm
